#include "pipeline/register/feature/surface_features.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace enamel::pipeline {
namespace {

constexpr int kTurns = 36;  // Lowe 2004: bins of the main direction
constexpr int kCells = 4;
constexpr int kDirections = 8;
constexpr float kTau = 2 * std::numbers::pi_v<float>;

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

/// A surface element in the tangent frame of a key point.
struct Local {
  float x, y;    ///< mm
  float gx, gy;  ///< its normal's tilt: sine, towards x and y
  float weight;  ///< area on the tangent plane, falling off from the centre
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

/// The surface around a key point, and the frame that it is described in.
class Surroundings {
 public:
  Surroundings(const SurfaceGrid& grid, const KeyPoint& key, const SurfaceFeatureConfig& config)
      : grid_(grid), key_(key), half_(static_cast<float>(config.half_width_mm)) {}

  /// False: too little of it is seen.
  bool gather(double min_known) {
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
      const float weight = area * facing * std::exp(-r2 / (2 * half_ * half_));
      elements.push_back({local.x(), local.y(), tilt.x(), tilt.y(), weight});
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

float angle_of(float x, float y) {
  const float a = std::atan2(y, x);
  return a < 0 ? a + kTau : a;
}

/// Main directions of slope, in the surroundings' frame, rad.
std::vector<float> main_directions(const std::vector<Local>& elements, double ratio) {
  std::array<float, kTurns> raw{};
  for (const Local& e : elements) {
    const float at = angle_of(e.gx, e.gy) * (kTurns / kTau);
    const auto bin = static_cast<std::size_t>(at) % kTurns;
    raw[bin] += e.weight * std::hypot(e.gx, e.gy);
  }
  std::array<float, kTurns> smooth = raw;
  for (int round = 0; round < 3; ++round) {
    const auto before = smooth;
    for (std::size_t k = 0; k < kTurns; ++k) {
      smooth[k] = 0.25F * before[(k + kTurns - 1) % kTurns] + 0.5F * before[k] + 0.25F * before[(k + 1) % kTurns];
    }
  }
  const float limit = static_cast<float>(ratio) * *std::max_element(smooth.begin(), smooth.end());
  std::vector<float> out;
  for (std::size_t k = 0; k < kTurns && out.size() < 3; ++k) {
    const float left = smooth[(k + kTurns - 1) % kTurns];
    const float right = smooth[(k + 1) % kTurns];
    if (!(smooth[k] >= limit && smooth[k] > left && smooth[k] >= right)) continue;
    const float shift = 0.5F * (left - right) / (left - 2 * smooth[k] + right);
    out.push_back((static_cast<float>(k) + 0.5F + shift) * (kTau / kTurns));
  }
  return out;
}

using Histogram = std::array<float, kCells * kCells * kDirections>;

/// Spreads one element over the two nearest cells each way and the two nearest directions.
void spread(Histogram& out, float cx, float cy, float direction, float value) {
  const int x0 = static_cast<int>(std::floor(cx));
  const int y0 = static_cast<int>(std::floor(cy));
  const int d0 = static_cast<int>(direction);
  for (int k = 0; k < 8; ++k) {
    const int x = x0 + k % 2;
    const int y = y0 + k / 2 % 2;
    const int d = (d0 + k / 4) % kDirections;
    if (x < 0 || y < 0 || x >= kCells || y >= kCells) continue;
    const float wx = 1 - std::abs(cx - static_cast<float>(x));
    const float wy = 1 - std::abs(cy - static_cast<float>(y));
    const float wd = k / 4 == 0 ? 1 - (direction - static_cast<float>(d0)) : direction - static_cast<float>(d0);
    out[static_cast<std::size_t>((y * kCells + x) * kDirections + d)] += value * wx * wy * wd;
  }
}

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

std::array<std::uint8_t, 128> describe(const std::vector<Local>& elements, float turn, float half) {
  const float c = std::cos(turn);
  const float s = std::sin(turn);
  const float per_mm = kCells / (2 * half);
  Histogram sums{};
  for (const Local& e : elements) {
    const float cx = (c * e.x + s * e.y) * per_mm + 0.5F * (kCells - 1);
    const float cy = (c * e.y - s * e.x) * per_mm + 0.5F * (kCells - 1);
    if (!(cx > -1 && cy > -1 && cx < kCells && cy < kCells)) continue;
    const float gx = c * e.gx + s * e.gy;
    const float gy = c * e.gy - s * e.gx;
    const float direction = std::min(angle_of(gx, gy) * (kDirections / kTau), kDirections - 1e-3F);
    spread(sums, cx, cy, direction, e.weight * std::hypot(gx, gy));
  }
  return to_bytes(sums);
}

}  // namespace

std::vector<SurfaceFeature> extract_surface_features(const SurfacePatch& patch, double px_per_mm,
                                                     const SurfaceFeatureConfig& config) {
  const SurfaceGrid grid = make_surface_grid(patch, px_per_mm, config.grid);
  std::vector<SurfaceFeature> out;
  for (const KeyPoint& key : find_key_points(grid, config)) {
    Surroundings around(grid, key, config);
    if (!around.gather(config.min_known)) continue;
    for (const float turn : main_directions(around.elements, config.peak_ratio)) {
      SurfaceFeature f;
      f.point = grid.points(key.u, key.v);
      f.axes.col(0) = std::cos(turn) * around.axes.col(0) + std::sin(turn) * around.axes.col(1);
      f.axes.col(2) = around.axes.col(2);
      f.axes.col(1) = f.axes.col(2).cross(f.axes.col(0));
      f.convex = key.bend > 0;
      f.descriptor = describe(around.elements, turn, static_cast<float>(config.half_width_mm));
      out.push_back(f);
    }
  }
  return out;
}

}  // namespace enamel::pipeline
