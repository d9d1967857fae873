#include "pipeline/register/feature/surface_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kTurns = 36;  // Lowe 2004: bins of the main direction
constexpr int kCells = 4;
constexpr int kDirections = 8;

struct KeyPoint {
  int u = 0, v = 0;
  float bend = 0;
};

/// The most or least bent within `apart`.
bool extreme(const SurfaceGrid& grid, const Map<float>& bend, int u, int v, float apart) {
  const int reach = static_cast<int>(apart / grid.pitch_mm) + 1;
  const float here = bend(u, v);
  const float sign = here > 0 ? 1.0F : -1.0F;
  for (int k = v - reach; k <= v + reach; ++k) {
    for (int i = u - reach; i <= u + reach; ++i) {
      if (!bend.contains(i, k) || (i == u && k == v)) continue;
      const bool near = (grid.points(i, k) - grid.points(u, v)).squaredNorm() < apart * apart;
      if (near && sign * bend(i, k) >= sign * here) return false;
    }
  }
  return true;
}

std::vector<KeyPoint> find_key_points(const SurfaceGrid& grid, const SurfaceFeatureConfig& config) {
  const Map<float> bend = bending(grid, config.bend_radius_mm);
  std::vector<KeyPoint> out;
  for (int v = 0; v < bend.height(); ++v) {
    for (int u = 0; u < bend.width(); ++u) {
      if (!(std::abs(bend(u, v)) > static_cast<float>(config.min_bend_per_mm))) continue;
      if (extreme(grid, bend, u, v, static_cast<float>(config.apart_mm))) out.push_back({u, v, bend(u, v)});
    }
  }
  std::sort(out.begin(), out.end(), [](const KeyPoint& a, const KeyPoint& b) {
    if (std::abs(a.bend) != std::abs(b.bend)) return std::abs(a.bend) > std::abs(b.bend);
    return a.v != b.v ? a.v < b.v : a.u < b.u;
  });
  if (out.size() > static_cast<std::size_t>(config.max_features)) {
    out.resize(static_cast<std::size_t>(config.max_features));
  }
  return out;
}

/// Of a vector, in turns, 0 to 1, to 1e-5 rad. Arithmetic alone: the same bits on every processor.
float direction_of(float x, float y) {
  const float low = std::min(std::abs(x), std::abs(y));
  const float high = std::max(std::abs(x), std::abs(y));
  const float q = high > 0 ? low / high : 0;
  const float q2 = q * q;
  // Abramowitz & Stegun 4.4.49: the arc tangent on 0 … 1.
  const float arc = q * (0.9998660F + q2 * (-0.3302995F + q2 * (0.1801410F + q2 * (-0.0851330F + q2 * 0.0208351F))));
  float turns = arc * (0.5F / std::numbers::pi_v<float>);
  if (std::abs(y) > std::abs(x)) turns = 0.25F - turns;
  if (x < 0) turns = 0.5F - turns;
  if (y < 0) turns = 1 - turns;
  return turns < 1 ? turns : 0;
}

/// A surface element in the tangent frame of a key point.
struct Local {
  float x, y;       ///< mm
  float direction;  ///< towards which its normal is tilted, turns
  float weight;     ///< sine of the tilt, times area on the tangent plane, falling off from the centre
};

/// Any frame whose z is n.
Eigen::Matrix3f frame_of(const Vec3f& n) {
  const Vec3f helper = std::abs(n.x()) < 0.6F ? Vec3f::UnitX() : Vec3f::UnitY();
  Eigen::Matrix3f axes;
  axes.col(2) = n;
  axes.col(0) = helper.cross(n).normalized();
  axes.col(1) = n.cross(axes.col(0));
  return axes;
}

/// The surface around one key point after the other, and the frame that it is described in.
class Surroundings {
 public:
  Surroundings(const SurfaceGrid& grid, const SurfaceFeatureConfig& config)
      : grid_(grid), half_(static_cast<float>(config.half_width_mm)) {}

  /// False: too little of it is seen.
  bool gather(const KeyPoint& key, double min_known) {
    key_ = key;
    elements.clear();
    const Vec3f mean = mean_normal();
    axes = frame_of(mean);
    const float reach2 = 2 * half_ * half_;
    float known = 0;
    visit(std::sqrt(reach2), [&](const Vec3f& d, const Vec3f& n, float area) {
      const float facing = n.dot(mean);
      const Vec3f local = axes.transpose() * d;
      const float r2 = local.head<2>().squaredNorm();
      // Another part of the surface, over or under this one, or a wall seen from few sides only.
      if (facing < 0.2F || r2 > reach2 || std::abs(local.z()) > half_) return;
      if (r2 < half_ * half_) known += area * facing;
      const Vec3f tilt = axes.transpose() * n;
      const float near = 1 - 0.5F * r2 / reach2;
      const float weight = area * facing * near * near * tilt.head<2>().norm();
      elements.push_back({local.x(), local.y(), direction_of(tilt.x(), tilt.y()), weight});
    });
    return known > static_cast<float>(min_known) * std::numbers::pi_v<float> * half_ * half_;
  }

  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();
  std::vector<Local> elements;

 private:
  template <class F>
  void visit(float radius, const F& f) const {
    const Vec3f p = grid_.points(key_.u, key_.v);
    const int reach = static_cast<int>(radius / grid_.pitch_mm) + 1;
    for (int v = std::max(0, key_.v - reach); v <= std::min(grid_.points.height() - 1, key_.v + reach); ++v) {
      for (int u = std::max(0, key_.u - reach); u <= std::min(grid_.points.width() - 1, key_.u + reach); ++u) {
        const float area = grid_.area_mm2(u, v);
        if (area > 0) f(grid_.points(u, v) - p, grid_.normals(u, v), area);
      }
    }
  }

  [[nodiscard]] Vec3f mean_normal() const {
    Vec3f sum = Vec3f::Zero();
    visit(half_, [&](const Vec3f& d, const Vec3f& n, float area) {
      const float r2 = d.squaredNorm() / (half_ * half_);
      if (r2 < 1) sum += area * (1 - r2) * n;
    });
    return sum.normalized();
  }

  const SurfaceGrid& grid_;
  KeyPoint key_;
  float half_;
};

/// Unit vectors in the main directions of slope, in the surroundings' frame.
struct MainDirections {
  std::array<Vec2f, 3> of;
  std::size_t count = 0;
};

MainDirections main_directions(const std::vector<Local>& elements, double ratio) {
  std::array<float, kTurns> smooth{};
  for (const Local& e : elements) {
    smooth[static_cast<std::size_t>(e.direction * static_cast<float>(kTurns)) % kTurns] += e.weight;
  }
  for (int round = 0; round < 3; ++round) {
    const auto before = smooth;
    for (std::size_t k = 0; k < kTurns; ++k) {
      smooth[k] = 0.25F * before[(k + kTurns - 1) % kTurns] + 0.5F * before[k] + 0.25F * before[(k + 1) % kTurns];
    }
  }
  std::array<Vec2f, kTurns> bins;  // their middles, by turning on and on
  bins[0] = {0.99619470F, 0.08715574F};
  for (std::size_t k = 1; k < kTurns; ++k) {
    bins[k] = {0.98480775F * bins[k - 1].x() - 0.17364818F * bins[k - 1].y(),
               0.17364818F * bins[k - 1].x() + 0.98480775F * bins[k - 1].y()};
  }
  const float limit = static_cast<float>(ratio) * *std::max_element(smooth.begin(), smooth.end());
  MainDirections out;
  for (std::size_t k = 0; k < kTurns && out.count < out.of.size(); ++k) {
    const std::size_t left = (k + kTurns - 1) % kTurns;
    const std::size_t right = (k + 1) % kTurns;
    if (!(smooth[k] >= limit && smooth[k] > smooth[left] && smooth[k] >= smooth[right])) continue;
    const float shift = 0.5F * (smooth[left] - smooth[right]) / (smooth[left] - 2 * smooth[k] + smooth[right]);
    const Vec2f& towards = shift < 0 ? bins[left] : bins[right];
    out.of[out.count++] = (bins[k] + std::abs(shift) * (towards - bins[k])).normalized();
  }
  return out;
}

using Histogram = std::array<float, kCells * kCells * kDirections>;

int floor_of(float x) {
  const int whole = static_cast<int>(x);
  return whole - (static_cast<float>(whole) > x ? 1 : 0);
}

/// A histogram with a rim of cells that nobody reads: spreading needs no limits.
class WideHistogram {
 public:
  /// Spreads one element over the two nearest cells each way and the two nearest directions. cx, cy in (-1, kCells).
  void spread(float cx, float cy, float direction, float value) {
    const int x0 = floor_of(cx), y0 = floor_of(cy);
    const int d0 = static_cast<int>(direction);
    const int d1 = (d0 + 1) % kDirections;
    const float beyond = direction - static_cast<float>(d0), before = 1 - beyond;
    for (int y = y0; y <= y0 + 1; ++y) {
      const float wy = 1 - std::abs(cy - static_cast<float>(y));
      for (int x = x0; x <= x0 + 1; ++x) {
        const float share = value * (1 - std::abs(cx - static_cast<float>(x))) * wy;
        float* cell = &sums_[static_cast<std::size_t>(((y + 1) * kWide + x + 1) * kDirections)];
        cell[d0] += share * before;
        cell[d1] += share * beyond;
      }
    }
  }
  [[nodiscard]] Histogram inner() const {
    Histogram out;
    for (int y = 0; y < kCells; ++y) {
      const auto from = sums_.begin() + ((y + 1) * kWide + 1) * kDirections;
      std::copy(from, from + kCells * kDirections, out.begin() + y * kCells * kDirections);
    }
    return out;
  }

 private:
  static constexpr int kWide = kCells + 2;
  std::array<float, kWide * kWide * kDirections> sums_{};
};

std::array<std::uint8_t, 128> to_bytes(Histogram h) {
  for (int round = 0; round < 2; ++round) {
    float sum = 0;
    for (const float x : h) sum += x * x;
    const float scale = sum > 0 ? 1 / std::sqrt(sum) : 0;
    for (float& x : h) x = std::min(x * scale, round == 0 ? 0.2F : 1.0F);
  }
  std::array<std::uint8_t, 128> out{};
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint8_t>(std::min(h[i] * 512, 255.0F));
  return out;
}

std::array<std::uint8_t, 128> describe(const std::vector<Local>& elements, const Vec2f& main, float half) {
  const float turn = direction_of(main.x(), main.y());
  const float per_mm = kCells / (2 * half);
  WideHistogram sums;
  for (const Local& e : elements) {
    const float cx = (main.x() * e.x + main.y() * e.y) * per_mm + 0.5F * (kCells - 1);
    const float cy = (main.x() * e.y - main.y() * e.x) * per_mm + 0.5F * (kCells - 1);
    if (!(cx > -1 && cy > -1 && cx < kCells && cy < kCells)) continue;
    const float turned = e.direction - turn;
    const float direction = (turned < 0 ? turned + 1 : turned) * kDirections;
    sums.spread(cx, cy, std::min(direction, kDirections - 1e-3F), e.weight);
  }
  return to_bytes(sums.inner());
}

}  // namespace

std::vector<SurfaceFeature> extract_surface_features(const SurfacePatch& patch, double px_per_mm,
                                                     const SurfaceFeatureConfig& config) {
  return extract_surface_features(make_surface_grid(patch, px_per_mm, config.grid), config);
}

std::vector<SurfaceFeature> extract_surface_features(const SurfaceGrid& grid, const SurfaceFeatureConfig& config) {
  std::vector<SurfaceFeature> out;
  Surroundings around(grid, config);
  for (const KeyPoint& key : find_key_points(grid, config)) {
    if (!around.gather(key, config.min_known)) continue;
    const MainDirections mains = main_directions(around.elements, config.peak_ratio);
    for (const Vec2f& main : std::span(mains.of).first(mains.count)) {
      SurfaceFeature f;
      f.point = grid.points(key.u, key.v);
      f.axes.col(0) = main.x() * around.axes.col(0) + main.y() * around.axes.col(1);
      f.axes.col(2) = around.axes.col(2);
      f.axes.col(1) = f.axes.col(2).cross(f.axes.col(0));
      f.convex = key.bend > 0;
      f.descriptor = describe(around.elements, main, static_cast<float>(config.half_width_mm));
      out.push_back(f);
    }
  }
  return out;
}

}  // namespace enamel::pipeline
