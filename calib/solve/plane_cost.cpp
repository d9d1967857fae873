#include "calib/solve/plane_cost.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/solve/ground.hpp"
#include "calib/solve/triangulate.hpp"

namespace enamel::calib {

namespace {

struct CellMean {
  std::vector<const GroundSample*> samples;
  std::vector<double> beyond_px;  ///< measured less predicted
};

/// Weighted mean over a cell as one sample; empty when too few are left.
std::optional<GroundSample> mean_of(const CellMean& cell, double limit_px) {
  constexpr int kMinSamples = 5;
  GroundSample mean;
  double weights = 0;
  int n = 0;
  for (std::size_t i = 0; i < cell.samples.size(); ++i) {
    if (std::abs(cell.beyond_px[i]) > limit_px) continue;
    const GroundSample& s = *cell.samples[i];
    const double w = 1 / s.variance_px2;
    weights += w;
    mean.camera_px += w * s.camera_px;
    mean.cell += w * s.cell;
    mean.projector_u_px += w * cell.beyond_px[i];
    ++n;
  }
  if (n < kMinSamples) return {};
  mean.camera_px /= weights;
  mean.cell /= weights;
  mean.projector_u_px /= weights;
  mean.variance_px2 = 1 / weights;
  return mean;
}

}  // namespace

double plane_depth_mm(const Pose& T_cam_target, const Vec3d& ray, double height_mm) {
  const Vec3d normal = T_cam_target.linear().col(2);
  return (normal.dot(T_cam_target.translation()) + height_mm) / normal.dot(ray);
}

std::vector<GroundSample> condensed(const std::vector<GroundSample>& ground, const TargetDesign& target,
                                    const RigState& state, const Pose& T_cam_target) {
  constexpr double kGross = 5 / 0.6745;  // five sigma in medians of the magnitude
  const auto predicted = [&](const GroundSample& s) {
    const Vec3d ray = camera_ray(state.camera, s.camera_px.x(), s.camera_px.y());
    const double height_mm = board_height_mm(target, s.cell, state.dot_offsets_mm);
    return projector_u(state, ray * plane_depth_mm(T_cam_target, ray, height_mm));
  };
  std::vector<CellMean> cells(static_cast<std::size_t>(target.size()));
  std::vector<double> size;
  for (const GroundSample& s : ground) {
    CellMean& cell =
        cells[static_cast<std::size_t>(target.index({static_cast<int>(s.cell.x()), static_cast<int>(s.cell.y())}))];
    cell.samples.push_back(&s);
    cell.beyond_px.push_back(s.projector_u_px - predicted(s));
    size.push_back(std::abs(cell.beyond_px.back()));
  }
  std::vector<GroundSample> out;
  if (size.empty()) return out;
  const auto half = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), half, size.end());
  for (const CellMean& cell : cells) {
    auto mean = mean_of(cell, kGross * *half);
    if (!mean) continue;
    mean->projector_u_px += predicted(*mean);
    out.push_back(*mean);
  }
  return out;
}

PlaneCost plane_cost(const GroundSample& sample, const TargetDesign& target, const RigState& state,
                     const Pose& T_cam_target, double variance_factor) {
  constexpr double kStep_px = 0.5, kStep_mm = 1e-3;
  const auto ray_at = [&](double du, double dv) {
    return camera_ray(state.camera, sample.camera_px.x() + du, sample.camera_px.y() + dv);
  };
  const Vec3d ray = ray_at(0, 0);
  const Vec3d along_u = (ray_at(kStep_px, 0) - ray_at(-kStep_px, 0)) / (2 * kStep_px);
  const Vec3d along_v = (ray_at(0, kStep_px) - ray_at(0, -kStep_px)) / (2 * kStep_px);
  const Vec3d p = triangulate(state, ray, sample.projector_u_px, T_cam_target.translation().z());
  PlaneCost cost;
  cost.camera_px = sample.camera_px;
  cost.projector_u_px = sample.projector_u_px;
  cost.height_mm = board_height_mm(target, sample.cell, state.dot_offsets_mm);
  cost.ray = {ray.x(), ray.y()};
  cost.px_to_ray << along_u.head<2>(), along_v.head<2>();
  cost.z_mm = p.z();
  cost.u_per_mm =
      (projector_u(state, ray * (p.z() + kStep_mm)) - projector_u(state, ray * (p.z() - kStep_mm))) / (2 * kStep_mm);
  const double sigma_mm = std::sqrt(sample.variance_px2 * variance_factor) *
                          std::abs(T_cam_target.linear().col(2).dot(ray) / cost.u_per_mm);
  cost.weight_per_mm = 1 / sigma_mm;
  return cost;
}

}  // namespace enamel::calib
