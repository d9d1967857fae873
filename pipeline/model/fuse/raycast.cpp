// TsdfModel::view: zero of the interpolated distance along every ray, by Newton steps from a hinted depth, by marching
// where that fails.
#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/model/fuse/depth_hint.hpp"
#include "pipeline/model/fuse/sampler.hpp"
#include "pipeline/model/fuse/tsdf_model.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kNewtonSteps = 6;
constexpr float kConvergedMm = 4e-3F;  ///< one more step from here is exact to 10 nm: derived, (4 um)^2 / 2R, R = 1 mm

/// Points o + s d in voxels, s = camera depth in mm.
struct Ray {
  Vec3f origin, direction;
  float mm_per_depth = 1;  ///< length of the ray per mm of camera depth
  [[nodiscard]] Vec3f at(float s) const { return origin + s * direction; }
};

class Caster {
 public:
  Caster(const BlockGrid& grid, const FuseConfig& config)
      : sampler_(grid),
        voxel_mm_(static_cast<float>(config.voxel_mm)),
        band_mm_(static_cast<float>(config.voxel_mm * config.truncation_voxels)) {}

  /// Front-facing zero near depth s; moves s. False if there is none within the band around the start.
  bool newton(const Ray& ray, float& s, Vec3f& gradient) {
    const float start = s;
    for (int k = 0; k < kNewtonSteps; ++k) {
      float d = 0.0F;
      if (!sampler_.sample(ray.at(s), d, gradient)) return false;
      const float slope = gradient.dot(ray.direction);  // change of distance per mm of depth
      if (!(slope < -0.1F)) return false;               // seen from behind, or too flat a field to trust
      s -= d / slope;
      if (std::fabs(d) < kConvergedMm) {
        // Trilinear interpolation shows a convex surface too deep, by voxel^2/6R on average: registration would sink.
        s += sampler_.excess_mm(ray.at(s)) / slope;
        return true;
      }
      if (std::fabs(s - start) > 2 * band_mm_) return false;
    }
    return false;
  }

  /// First change from outside to inside between the depths.
  bool march(const Ray& ray, float from, float to, float& s, Vec3f& gradient) {
    const float fine = 0.5F * voxel_mm_ / ray.mm_per_depth;
    if (!(from + fine > from)) return false;  // so long a ray of so poor a lens that steps are lost in rounding
    bool outside = false;
    for (float at = from; at <= to;) {
      float d = 0.0F;
      if (!sampler_.sample(ray.at(at), d, gradient)) {
        outside = false;
        at += 2 * fine;
        // Steps that stay where there is no block would find nothing either.
        for (const float end = std::min(to, sampler_.void_until(ray.origin, ray.direction)); at < end;) at += 2 * fine;
        continue;
      }
      if (d <= 0.0F && outside) {
        s = at;
        return newton(ray, s, gradient);
      }
      outside = d > 0.0F;
      at += std::max(fine, 0.8F * d / ray.mm_per_depth);
    }
    return false;
  }

 private:
  Sampler sampler_;
  float voxel_mm_, band_mm_;
};

}  // namespace

ModelView TsdfModel::view(const Pose& T_model_cam, const SurfacePatch& hint) {
  ModelView view;
  view.T_model_cam = T_model_cam;
  view.after_burst = after_burst_;
  view.stride = view_stride_;
  const bool fits = hint.depth_mm.width() == camera_.width && hint.depth_mm.height() == camera_.height;
  if (empty() || !fits || hint.depth_mm.empty() || !T_model_cam.matrix().allFinite()) {
    return view;
  }
  view.empty = false;
  const int width = (camera_.width + view.stride - 1) / view.stride;
  const int height = (camera_.height + view.stride - 1) / view.stride;
  view.points = Map<Vec3f>(width, height, Vec3f::Constant(kNan));
  view.normals = Map<Vec3f>(width, height, Vec3f::Zero());
  planes_.clear(width, height);
  coarse_.build(hint.depth_mm);
  Caster caster(grid_, config_);
  Ray ray;
  ray.origin = (T_model_cam.translation() / config_.voxel_mm).cast<float>();
  const Eigen::Matrix3f R = T_model_cam.linear().cast<float>();
  const Vec3f t = T_model_cam.translation().cast<float>();
  const auto per_voxel = static_cast<float>(1 / config_.voxel_mm);
  const auto band = static_cast<float>(config_.voxel_mm * config_.truncation_voxels);
  const auto search = static_cast<float>(config_.view_search_mm);
  const auto slope = [&](int i, double c, double f) { return static_cast<float>((i * view_stride_ - c) / f); };
  // Pixels without a point keep the gradients of an earlier view: nobody asks for them.
  for (int j = 0; j < height; ++j) {
    const float y = slope(j, camera_.cy, camera_.fy);
    for (int i = 0; i < width; ++i) {
      const int u = i * view.stride;
      const int v = j * view.stride;
      const float own = hint.depth_mm(u, v);
      const float guess = std::isnan(own) ? coarse_.near_pixel(u, v) : own;
      if (!(guess > 0.0F)) continue;
      const Vec3f in_camera(slope(i, camera_.cx, camera_.fx), y, 1.0F);
      const Vec3f in_model = R * in_camera;
      ray.direction = in_model * per_voxel;
      ray.mm_per_depth = in_camera.norm();
      float s = guess;
      Vec3f gradient = Vec3f::Zero();
      const float range = std::isnan(own) ? search : band;
      if (!caster.newton(ray, s, gradient) && !caster.march(ray, guess - range, guess + range, s, gradient)) continue;
      view.points(i, j) = t + s * in_model;
      planes_.put(i, j, view.points(i, j), gradient);
    }
  }
  smooth_normals(planes_, view.normals);
  return view;
}

}  // namespace enamel::pipeline
