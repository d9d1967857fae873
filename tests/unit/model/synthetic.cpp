#include "tests/unit/model/synthetic.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace enamel::synthetic {

double Random::uniform() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  z ^= z >> 31U;
  return (static_cast<double>(z >> 11U) + 0.5) * 0x1.0p-53;
}

Vec3d Random::vector() {
  Vec3d v;
  for (int k = 0; k < 3; ++k) {
    v[k] = uniform() - 0.5;
  }
  return v;
}

double Random::normal() {
  const double radius = std::sqrt(-2.0 * std::log(uniform()));
  const double angle = 2.0 * M_PI * uniform();
  return radius * std::cos(angle);
}

Surface sphere(const Vec3d& centre, double radius_mm) {
  return [=](const Vec3d& origin, const Vec3d& direction) -> std::optional<Hit> {
    const Vec3d oc = origin - centre;
    const double a = direction.squaredNorm();
    const double b = oc.dot(direction);
    const double disc = b * b - a * (oc.squaredNorm() - radius_mm * radius_mm);
    if (disc <= 0) {
      return std::nullopt;
    }
    const double t = (-b - std::sqrt(disc)) / a;
    const Vec3d p = origin + t * direction;
    return t > 0 ? std::optional<Hit>(Hit{t, (p - centre) / radius_mm}) : std::nullopt;
  };
}

Surface plane(const Vec3d& normal, double offset_mm) {
  const Vec3d n = normal.normalized();
  return [=](const Vec3d& origin, const Vec3d& direction) -> std::optional<Hit> {
    const double along = n.dot(direction);
    const double t = (offset_mm - n.dot(origin)) / along;
    return along < 0 && t > 0 ? std::optional<Hit>(Hit{t, n}) : std::nullopt;
  };
}

Surface wedge(double radius_mm) {
  // Faces tangent to the cylinder about (0, y, c) at +-45 degrees; its top is z = 0.
  const double c = radius_mm;
  const double reach = radius_mm * std::sqrt(0.5);  // |x| where the faces begin
  return [=](const Vec3d& origin, const Vec3d& direction) {
    std::optional<Hit> best;
    for (const double side : {-1.0, 1.0}) {
      const Vec3d n = Vec3d(side, 0, -1).normalized();
      const auto hit = plane(n, radius_mm + n.dot(Vec3d(0, 0, c)))(origin, direction);
      if (hit && (origin + hit->t * direction).x() * side >= reach && (!best || hit->t < best->t)) {
        best = hit;
      }
    }
    const Eigen::Vector2d o(origin.x(), origin.z() - c);
    const Eigen::Vector2d d(direction.x(), direction.z());
    const double b = o.dot(d);
    const double disc = b * b - d.squaredNorm() * (o.squaredNorm() - radius_mm * radius_mm);
    if (disc > 0) {
      const double t = (-b - std::sqrt(disc)) / d.squaredNorm();
      const Vec3d p = origin + t * direction;
      if (std::abs(p.x()) < reach && (!best || t < best->t)) {
        best = Hit{t, Vec3d(p.x(), 0, p.z() - c) / radius_mm};
      }
    }
    return best;
  };
}

Surface nearest(Surface a, Surface b) {
  return [a = std::move(a), b = std::move(b)](const Vec3d& origin, const Vec3d& direction) {
    const auto first = a(origin, direction);
    const auto second = b(origin, direction);
    return !second || (first && first->t < second->t) ? first : second;
  };
}

Surface clipped(Surface a, std::function<bool(const Vec3d&)> inside) {
  return [a = std::move(a), inside = std::move(inside)](const Vec3d& origin, const Vec3d& direction) {
    auto hit = a(origin, direction);
    return hit && inside(origin + hit->t * direction) ? hit : std::nullopt;
  };
}

calib::Rig rig() {
  calib::Rig rig;
  rig.camera = {640, 480, 1707.0, 1707.0, 321.3, 238.1, {-0.05, 0.01, 0.0003, -0.0002, 0.0}};
  return rig;
}

calib::Rig small_rig() {
  calib::Rig rig;
  rig.camera = {320, 240, 853.5, 853.5, 160.4, 118.8, {-0.05, 0.01, 0.0003, -0.0002, 0.0}};
  return rig;
}

Pose looking_at(const Vec3d& target, const Vec3d& direction, double distance_mm, double roll_rad) {
  const Vec3d z = direction.normalized();
  const Vec3d x = (std::abs(z.x()) < 0.9 ? Vec3d::UnitX() : Vec3d::UnitY()).cross(z).cross(z).normalized() * -1.0;
  Pose pose = Pose::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.linear() = pose.linear() * Eigen::AngleAxisd(roll_rad, Vec3d::UnitZ()).toRotationMatrix();
  pose.translation() = target - distance_mm * z;
  return pose;
}

Vec3d pixel_ray(const calib::LensValues& lens, double u, double v) {
  const double xd = (u - lens.cx) / lens.fx;
  const double yd = (v - lens.cy) / lens.fy;
  double x = xd;
  double y = yd;
  for (int k = 0; k < 50; ++k) {
    const double r2 = x * x + y * y;
    const double g = 1 + r2 * (lens.dist[0] + r2 * (lens.dist[1] + r2 * lens.dist[4]));
    const double dx = 2 * lens.dist[2] * x * y + lens.dist[3] * (r2 + 2 * x * x);
    const double dy = lens.dist[2] * (r2 + 2 * y * y) + 2 * lens.dist[3] * x * y;
    x = (xd - dx) / g;
    y = (yd - dy) / g;
  }
  return {x, y, 1.0};
}

namespace {

Vec3d jittered(const Vec3d& normal, Random& random) {
  Vec3d noise;
  for (int k = 0; k < 3; ++k) {  // one after the other: the order of evaluation of arguments differs between compilers
    noise[k] = random.normal();
  }
  return (normal + 0.03 * noise).normalized();
}

}  // namespace

SurfacePatch render(const calib::Rig& rig, const Surface& surface, const Pose& T_model_cam,
                    const RenderOptions& options) {
  const int w = rig.camera.width;
  const int h = rig.camera.height;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SurfacePatch patch;
  patch.depth_mm = patch.sigma_mm = Map<float>(w, h, kNan);
  patch.points = patch.normals = Map<Vec3f>(w, h, Vec3f::Constant(kNan));
  patch.texture_dn = patch.modulation_dn = Map<float>(w, h, 100.0F);
  Random random(options.seed);
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      const Vec3d ray = pixel_ray(rig.camera, u, v);
      const auto hit = surface(T_model_cam.translation(), T_model_cam.linear() * ray);
      if (!hit) {
        continue;
      }
      const double z = hit->t + (options.noisy ? options.sigma_mm * random.normal() : 0.0);
      const Vec3d n = T_model_cam.linear().transpose() * hit->normal;
      patch.depth_mm(u, v) = static_cast<float>(z);
      patch.sigma_mm(u, v) = static_cast<float>(options.sigma_mm);
      patch.points(u, v) = (z * ray).cast<float>();
      patch.normals(u, v) = (options.noisy ? jittered(n, random) : n).cast<float>();
      ++patch.valid_px;
    }
  }
  return patch;
}

}  // namespace enamel::synthetic
