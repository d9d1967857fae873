// Teeth and gum: heights at the nodes of a grid, bilinear between, with the slopes of the nodes interpolated alike.
// What lies outside of the grid is not there.
#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/types/map.hpp"
#include "tests/support/draw/shape.hpp"

namespace enamel::test {
namespace {

constexpr double kCell_mm = 0.05, kHalf_mm = 13;
constexpr int kCells = 520, kBlock = 13, kBlocks = kCells / kBlock;  ///< blocks know how high they are at most
constexpr double kShadow_mm = 0.003;  ///< that much higher than the ray must be what hides the light
constexpr double kTurn = 6.283185307179586;

double gum_height(const SceneValues& s, double x, double y) {
  double z = 0;
  for (const SurfaceWave& w : s.waves) z += w.height_mm * std::sin(w.x_per_mm * x + w.y_per_mm * y + w.phase_rad);
  return z;
}

/// Above the gum's level; below 0: this tooth is elsewhere.
double tooth_height(const DrawnTooth& t, double x, double y) {
  const double dx = (x - t.x_mm) / t.half_x_mm, dy = (y - t.y_mm) / t.half_y_mm;
  const double r4 = dx * dx * dx * dx + dy * dy * dy * dy;
  if (r4 >= 1) return -1;
  const double out = std::sqrt(std::sqrt(r4));
  double share = 1 - t.rounding * r4;
  if (t.flank > 0 && out > 1 - t.flank) {
    const double down = (1 - out) / t.flank;
    share *= down * (2 - down);
  }
  return std::max(0.0, t.rise_mm * share + t.cusp_mm * std::cos(kTurn * 0.4 * (x - t.x_mm)) *
                                               std::cos(kTurn * 0.4 * (y - t.y_mm)) * (1 - r4));
}

/// From where on its way and to where a ray is above the grid and not above all that is high.
struct Way {
  double from = 0, to = 0;
};

class HeightShape final : public SceneShape {
 public:
  explicit HeightShape(const SceneValues& s)
      : height_(kCells + 1, kCells + 1), tooth_(kCells + 1, kCells + 1), block_(kBlocks, kBlocks, -100) {
    for (int j = 0; j <= kCells; ++j) {
      for (int i = 0; i <= kCells; ++i) raise(s, i, j);
    }
    for (int j = 0; j < kCells; ++j) {
      for (int i = 0; i < kCells; ++i) {
        const float cell = std::max({height_(i, j), height_(i + 1, j), height_(i, j + 1), height_(i + 1, j + 1)});
        float& most = block_(i / kBlock, j / kBlock);
        most = std::max(most, cell);
        top_ = std::max(top_, static_cast<double>(cell));
        floor_ = std::min(floor_, static_cast<double>(std::min(height_(i, j), height_(i + 1, j + 1))));
      }
    }
  }

  SceneHit hit(const SceneRay& ray) const override {
    SceneHit out;
    Way way{0, 1e9};
    if (!clip(ray, way)) return out;
    const double at = march(ray, way, 0);
    if (!(at <= way.to)) return out;
    const Point3 p = ray.origin + at * ray.direction;
    out.at = at;
    const Place c = place(p.x(), p.y());
    out.normal = normal_at(c);
    out.gum = tooth_(c.x > 0.5 ? c.i + 1 : c.i, c.y > 0.5 ? c.j + 1 : c.j) == 0;
    out.face = out.gum ? 1 : 2;
    return out;
  }

  bool blocks(const Point3& from, const SceneHit& hit_at, const Point3& light) const override {
    const Point3 start = from + kShadow_mm * hit_at.normal;
    const SceneRay ray{start, light - start};
    Way way{0, 1};
    if (!clip(ray, way)) return false;
    return march(ray, way, kShadow_mm) <= way.to;
  }

 private:
  struct Place {
    int i = 0, j = 0;
    double x = 0, y = 0;  ///< within the cell, 0 … 1
  };

  void raise(const SceneValues& s, int i, int j) {
    const double x = i * kCell_mm - kHalf_mm, y = j * kCell_mm - kHalf_mm, gum = gum_height(s, x, y);
    double z = gum;
    for (const DrawnTooth& t : s.teeth) {
      const double up = tooth_height(t, x, y);
      if (up <= z) continue;
      z = up;
      tooth_(i, j) = 1;
    }
    height_(i, j) = static_cast<float>(z);
  }

  static Place place(double x, double y) {
    const double gx = std::clamp((x + kHalf_mm) / kCell_mm, 0.0, kCells - 1e-6);
    const double gy = std::clamp((y + kHalf_mm) / kCell_mm, 0.0, kCells - 1e-6);
    const int i = static_cast<int>(gx), j = static_cast<int>(gy);
    return {i, j, gx - i, gy - j};
  }

  double height_at(double x, double y) const {
    const Place p = place(x, y);
    const float* row = &height_(p.i, p.j);
    const double a = static_cast<double>(row[0]), b = static_cast<double>(row[1]);
    const double c = static_cast<double>(row[kCells + 1]), d = static_cast<double>(row[kCells + 2]);
    const double low = a + p.x * (b - a), high = c + p.x * (d - c);
    return low + p.y * (high - low);
  }

  Point3 normal_at(const Place& p) const {
    const auto at = [&](int i, int j) {
      return static_cast<double>(height_(std::clamp(i, 0, kCells), std::clamp(j, 0, kCells)));
    };
    double dx = 0, dy = 0;
    for (int n = 0; n < 4; ++n) {
      const int i = p.i + n % 2, j = p.j + n / 2;
      const double w = (n % 2 == 1 ? p.x : 1 - p.x) * (n / 2 == 1 ? p.y : 1 - p.y);
      dx += w * (at(i + 1, j) - at(i - 1, j));
      dy += w * (at(i, j + 1) - at(i, j - 1));
    }
    return Point3(-dx, -dy, 2 * kCell_mm).normalized();
  }

  bool clip(const SceneRay& ray, Way& way) const {
    const std::array<double, 3> low = {-kHalf_mm, -kHalf_mm, floor_ - 0.1}, high = {kHalf_mm, kHalf_mm, top_ + 0.01};
    for (int k = 0; k < 3; ++k) {
      const double inverse = 1 / ray.direction(k);
      double a = (low[static_cast<std::size_t>(k)] - ray.origin(k)) * inverse;
      double b = (high[static_cast<std::size_t>(k)] - ray.origin(k)) * inverse;
      if (a > b) std::swap(a, b);
      way.from = std::max(way.from, a), way.to = std::min(way.to, b);
    }
    return way.from < way.to;
  }

  /// Where the ray first is `deep` below the surface; past way.to: nowhere.
  double march(const SceneRay& ray, const Way& way, double deep) const {
    const Point3 &o = ray.origin, &e = ray.direction;
    const auto above = [&](double t) {
      return o.z() + t * e.z() - height_at(o.x() + t * e.x(), o.y() + t * e.y()) + deep;
    };
    const double along = std::max({std::abs(e.x()), std::abs(e.y()), 1e-3 * std::abs(e.z())});
    const double step = 0.7 * kCell_mm / along, beyond = 1e-4 * step;
    double t = way.from;
    const double nowhere = std::nextafter(way.to, 2 * way.to + 1);
    if (above(t) < 0) return nowhere;  // in by the grid's side
    while (t < way.to) {
      const double leave = std::min(way.to, block_end(ray, t) + beyond);
      const Place p = place(o.x() + (t + beyond) * e.x(), o.y() + (t + beyond) * e.y());
      // Only below the block's highest place can it meet anything.
      const double top = (static_cast<double>(block_(p.i / kBlock, p.j / kBlock)) - deep - o.z()) / e.z();
      const double stop = e.z() > 0 ? std::min(leave, top) : leave;
      if (e.z() < 0) t = std::max(t, top);
      double last = t < stop ? above(t) : 0;
      if (last < 0) return t;
      while (t < stop) {
        const double next = std::min(stop, t + step), f = above(next);
        if (f < 0) return cross(above, {t, next}, last, f);
        t = next, last = f;
      }
      t = leave;
    }
    return nowhere;
  }

  /// Where the ray leaves the block that it is in.
  static double block_end(const SceneRay& ray, double t) {
    constexpr double kSide_mm = kBlock * kCell_mm;
    double end = 1e9;
    for (int k = 0; k < 2; ++k) {
      const double at = (ray.origin(k) + t * ray.direction(k) + kHalf_mm) / kSide_mm, d = ray.direction(k);
      if (d == 0) continue;
      const double border = d > 0 ? std::floor(at + 1e-6) + 1 : std::ceil(at - 1e-6) - 1;
      end = std::min(end, (border * kSide_mm - kHalf_mm - ray.origin(k)) / d);
    }
    return std::max(end, t);
  }

  /// Illinois method between a place above the surface and one below.
  template <class Above>
  static double cross(const Above& above, Way between, double f, double g) {
    double a = between.from, b = between.to, t = b;
    int kept = 0;
    for (int k = 0; k < 40; ++k) {
      t = (a * g - b * f) / (g - f);
      const double h = above(t);
      if (std::abs(h) < 1e-8) break;
      if (h < 0) {
        b = t, g = h;
        if (kept == 1) f *= 0.5;
        kept = 1;
      } else {
        a = t, f = h;
        if (kept == 2) g *= 0.5;
        kept = 2;
      }
    }
    return t;
  }

  Map<float> height_;
  Map<std::uint8_t> tooth_;
  Map<float> block_;
  double top_ = -100, floor_ = 100;
};

}  // namespace

std::unique_ptr<const SceneShape> make_height_shape(const SceneValues& scene) {
  return std::make_unique<HeightShape>(scene);
}

}  // namespace enamel::test
