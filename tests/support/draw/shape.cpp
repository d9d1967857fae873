#include "tests/support/draw/shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace enamel::test {
namespace {

constexpr double kOff_mm = 1e-5;  ///< a ray to the light begins this far outside of the surface that it leaves

/// z = 0, endless.
SceneHit plane_hit(const SceneRay& ray) {
  SceneHit hit;
  const double at = -ray.origin.z() / ray.direction.z();
  if (at > 0) hit.at = at;
  return hit;
}

class PlaneShape final : public SceneShape {
 public:
  SceneHit hit(const SceneRay& ray) const override { return plane_hit(ray); }
  bool blocks(const Point3& /*from*/, const SceneHit& /*hit*/, const Point3& light) const override {
    return light.z() <= 0;
  }
};

/// Two balls on a rod along x, between x = -d/2 and d/2.
class BallsShape final : public SceneShape {
 public:
  explicit BallsShape(const Balls& b) : balls_(b) {}

  SceneHit hit(const SceneRay& ray) const override {
    SceneHit first;
    ball(ray, -0.5 * balls_.distance_mm, balls_.left_radius_mm, 1, first);
    ball(ray, 0.5 * balls_.distance_mm, balls_.right_radius_mm, 2, first);
    rod(ray, first);
    return first;
  }
  bool blocks(const Point3& from, const SceneHit& hit_at, const Point3& light) const override {
    const Point3 start = from + kOff_mm * hit_at.normal;
    return hit({start, light - start}).at < 1;
  }

 private:
  static void ball(const SceneRay& ray, double x, double radius, int face, SceneHit& first) {
    const Point3 o = ray.origin - Point3(x, 0, 0);
    const double a = ray.direction.squaredNorm(), b = o.dot(ray.direction), c = o.squaredNorm() - radius * radius;
    const double d = b * b - a * c;
    if (d <= 0) return;
    const double at = (-b - std::sqrt(d)) / a;
    if (at <= 0 || at >= first.at) return;
    first = {at, (o + at * ray.direction) / radius, face, false};
  }
  void rod(const SceneRay& ray, SceneHit& first) const {
    const Point3 &o = ray.origin, &e = ray.direction;
    const double a = e.y() * e.y() + e.z() * e.z(), b = o.y() * e.y() + o.z() * e.z();
    const double c = o.y() * o.y() + o.z() * o.z() - balls_.rod_radius_mm * balls_.rod_radius_mm, d = b * b - a * c;
    if (d <= 0 || a <= 0) return;
    const double at = (-b - std::sqrt(d)) / a;
    const Point3 p = o + at * e;
    if (at <= 0 || at >= first.at || std::abs(p.x()) > 0.5 * balls_.distance_mm) return;
    first = {at, Point3(0, p.y(), p.z()) / balls_.rod_radius_mm, 3, false};
  }
  Balls balls_;
};

/// Boxes that stand on the plane.
class BoxesShape final : public SceneShape {
 public:
  explicit BoxesShape(const std::vector<Box>& boxes) {
    for (const Box& b : boxes) {
      boxes_.push_back(
          {b, std::cos(b.turn_rad), std::sin(b.turn_rad), b.half_x_mm * b.half_x_mm + b.half_y_mm * b.half_y_mm});
    }
  }

  SceneHit hit(const SceneRay& ray) const override {
    SceneHit first = plane_hit(ray);
    first_box(ray, first);
    return first;
  }
  bool blocks(const Point3& from, const SceneHit& hit_at, const Point3& light) const override {
    const Point3 start = from + kOff_mm * hit_at.normal;
    SceneHit first;
    first.at = 1;
    first_box({start, light - start}, first);
    return first.at < 1;
  }

 private:
  struct Turned {
    Box box;
    double c = 1, s = 0, reach2 = 0;
  };

  void first_box(const SceneRay& ray, SceneHit& first) const {
    const Point3 &o = ray.origin, &e = ray.direction;
    const double along2 = e.x() * e.x() + e.y() * e.y();
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const Box& b = boxes_[k].box;
      const double aside = (b.x_mm - o.x()) * e.y() - (b.y_mm - o.y()) * e.x();
      if (aside * aside <= boxes_[k].reach2 * along2) meet(ray, boxes_[k], static_cast<int>(k), first);
    }
  }

  static void meet(const SceneRay& ray, const Turned& t, int k, SceneHit& first) {
    const Box& b = t.box;
    const double dx = ray.origin.x() - b.x_mm, dy = ray.origin.y() - b.y_mm;
    const std::array<double, 3> o = {t.c * dx + t.s * dy, t.c * dy - t.s * dx, ray.origin.z()};
    const std::array<double, 3> e = {t.c * ray.direction.x() + t.s * ray.direction.y(),
                                     t.c * ray.direction.y() - t.s * ray.direction.x(), ray.direction.z()};
    const std::array<double, 3> low = {-b.half_x_mm, -b.half_y_mm, -1}, high = {b.half_x_mm, b.half_y_mm, b.height_mm};
    double enter = 0, leave = first.at;
    int axis = -1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double inverse = 1 / e[i];
      double a = (low[i] - o[i]) * inverse, c = (high[i] - o[i]) * inverse;
      if (a > c) std::swap(a, c);
      if (a > enter) enter = a, axis = static_cast<int>(i);
      leave = std::min(leave, c);
    }
    if (axis < 0 || enter >= leave) return;
    const double sign = e[static_cast<std::size_t>(axis)] > 0 ? -1 : 1;
    Point3 normal = Point3::UnitZ();
    if (axis == 0) normal = sign * Point3(t.c, t.s, 0);
    if (axis == 1) normal = sign * Point3(-t.s, t.c, 0);
    first = {enter, normal, 8 + 8 * k + 2 * axis + (sign > 0 ? 1 : 0), false};
  }

  std::vector<Turned> boxes_;
};

}  // namespace

std::unique_ptr<const SceneShape> make_shape(const SceneValues& scene) {
  switch (scene.kind) {
    case SceneKind::kPlane:
      return std::make_unique<PlaneShape>();
    case SceneKind::kBalls:
      return std::make_unique<BallsShape>(scene.balls);
    case SceneKind::kBoxes:
      return std::make_unique<BoxesShape>(scene.boxes);
    case SceneKind::kTeeth:
    case SceneKind::kGum:
      break;
  }
  return make_height_shape(scene);
}

}  // namespace enamel::test
