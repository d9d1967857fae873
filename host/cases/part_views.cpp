#include "host/cases/part_views.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace enamel::host {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

class Drawing {
 public:
  Drawing(const PartSurface& part, const Pose& T_part_view, const ViewShape& shape)
      : mesh_(part.mesh()),
        T_view_part_(T_part_view.inverse().cast<float>()),
        middle_(static_cast<float>(shape.size_px - 1) / 2),
        focal_px_(static_cast<float>(shape.px_per_mm * shape.distance_mm)),
        depth_(shape.size_px, shape.size_px, std::numeric_limits<float>::infinity()) {
    const int n = shape.size_px;
    patch_.depth_mm = patch_.sigma_mm = patch_.texture_dn = patch_.modulation_dn = Map<float>(n, n, kNothing);
    patch_.points = patch_.normals = Map<Vec3f>(n, n, Vec3f::Constant(kNothing));
  }

  SurfacePatch draw(float near_mm, float far_mm) {
    std::vector<Vec3f> at;
    at.reserve(mesh_.vertices.size());
    for (const Vec3f& v : mesh_.vertices) at.push_back(T_view_part_ * v);
    for (const auto& t : mesh_.triangles) {
      const bool within =
          std::ranges::all_of(t, [&](std::uint32_t v) { return at[v].z() > near_mm && at[v].z() < far_mm; });
      if (within) draw_face(at[t[0]], at[t[1]], at[t[2]], t);
    }
    for (std::size_t i = 0; i < patch_.points.size(); ++i) patch_.valid_px += std::isnan(patch_.depth_mm[i]) ? 0U : 1U;
    return std::move(patch_);
  }

 private:
  [[nodiscard]] Vec2f pixel(const Vec3f& p) const {
    return Vec2f(p.x(), p.y()) * (focal_px_ / p.z()) + Vec2f::Constant(middle_);
  }

  void draw_face(const Vec3f& a, const Vec3f& b, const Vec3f& c, const std::array<std::uint32_t, 3>& t) {
    const Vec2f p = pixel(a), q = pixel(b), r = pixel(c);
    const float twice = (q - p).x() * (r - p).y() - (q - p).y() * (r - p).x();
    if (twice == 0) return;
    const Vec2f low = p.cwiseMin(q).cwiseMin(r), high = p.cwiseMax(q).cwiseMax(r);
    const int size = depth_.width();
    const int u0 = std::max(0, static_cast<int>(std::ceil(low.x()))),
              v0 = std::max(0, static_cast<int>(std::ceil(low.y())));
    const int u1 = std::min(size - 1, static_cast<int>(std::floor(high.x())));
    const int v1 = std::min(size - 1, static_cast<int>(std::floor(high.y())));
    const bool front = (b - a).cross(c - a).dot(a) < 0;
    for (int v = v0; v <= v1; ++v) {
      for (int u = u0; u <= u1; ++u) {
        const Vec2f at(static_cast<float>(u), static_cast<float>(v));
        const float wq = ((at - p).x() * (r - p).y() - (at - p).y() * (r - p).x()) / twice;
        const float wr = ((q - p).x() * (at - p).y() - (q - p).y() * (at - p).x()) / twice;
        const float wp = 1 - wq - wr;
        if (wp < 0 || wq < 0 || wr < 0) continue;
        put(patch_.points.index(u, v), wp * a + wq * b + wr * c,
            wp * mesh_.normals[t[0]] + wq * mesh_.normals[t[1]] + wr * mesh_.normals[t[2]], front);
      }
    }
  }

  void put(std::size_t i, const Vec3f& point, const Vec3f& normal, bool front) {
    constexpr float kSigma_mm = 0.01F;  // of a fused surface; nothing here depends on it
    if (point.z() >= depth_[i]) return;
    depth_[i] = point.z();
    const Vec3f n = T_view_part_.linear() * normal.normalized();
    const bool seen = front && n.dot(point) < 0;
    patch_.depth_mm[i] = seen ? point.z() : kNothing;
    patch_.sigma_mm[i] = seen ? kSigma_mm : kNothing;
    patch_.points[i] = seen ? point : Vec3f::Constant(kNothing);
    patch_.normals[i] = seen ? n : Vec3f::Constant(kNothing);
  }

  const Mesh& mesh_;
  Eigen::Isometry3f T_view_part_;
  float middle_, focal_px_;
  Map<float> depth_;
  SurfacePatch patch_;
};

/// Looks against the normal.
Pose view_at(const SurfaceElement& element, double distance_mm) {
  Pose out = Pose::Identity();
  const Vec3d z = -element.normal, x = z.unitOrthogonal();
  out.linear().col(0) = x;
  out.linear().col(1) = z.cross(x);
  out.linear().col(2) = z;
  out.translation() = element.point - distance_mm * z;
  return out;
}

}  // namespace

SurfacePatch draw_part(const PartSurface& part, const Pose& T_part_view, const ViewShape& shape) {
  return Drawing(part, T_part_view, shape)
      .draw(static_cast<float>(shape.distance_mm - shape.reach_mm),
            static_cast<float>(shape.distance_mm + shape.reach_mm));
}

std::vector<PartView> views_of(const PartSurface& part, const ViewShape& shape) {
  pipeline::SurfaceFeatureConfig config;
  config.max_features = shape.max_features;
  const double min_cos = std::cos(shape.apart_deg * std::numbers::pi / 180);
  std::vector<PartView> out;
  for (const SurfaceElement& e : part.coarse()) {
    const bool seen = std::ranges::any_of(out, [&](const PartView& view) {
      return (view.target - e.point).norm() < shape.apart_mm &&
             -view.T_part_view.linear().col(2).dot(e.normal) > min_cos;
    });
    if (seen) continue;
    PartView view{view_at(e, shape.distance_mm), e.point, {}};
    view.features =
        pipeline::extract_surface_features(draw_part(part, view.T_part_view, shape), shape.px_per_mm, config);
    out.push_back(std::move(view));
  }
  return out;
}

}  // namespace enamel::host
