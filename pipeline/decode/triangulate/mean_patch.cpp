#include "pipeline/decode/triangulate/mean_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace enamel::pipeline {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

struct Measured {
  float depth_mm, sigma_mm;
};

/// NaN where too few agree.
Measured mean_of(std::vector<Measured>& at, float gate_sigmas, std::size_t min_agreeing) {
  if (at.size() < min_agreeing) return {kNoDepth, kNoDepth};
  const auto middle = at.begin() + static_cast<std::ptrdiff_t>(at.size() / 2);
  std::nth_element(at.begin(), middle, at.end(),
                   [](const Measured& a, const Measured& b) { return a.depth_mm < b.depth_mm; });
  const Measured median = *middle;
  double sum = 0, weight = 0;
  std::size_t agreeing = 0;
  for (const Measured& m : at) {
    const float apart = std::abs(m.depth_mm - median.depth_mm);
    if (apart > gate_sigmas * std::hypot(m.sigma_mm, median.sigma_mm)) continue;
    const double w = 1.0 / (static_cast<double>(m.sigma_mm) * static_cast<double>(m.sigma_mm));
    sum += w * static_cast<double>(m.depth_mm);
    weight += w;
    ++agreeing;
  }
  if (agreeing < min_agreeing) return {kNoDepth, kNoDepth};
  return {static_cast<float>(sum / weight), static_cast<float>(std::sqrt(1 / weight))};
}

}  // namespace

SurfacePatch mean_patch(std::span<const SurfacePatch> patches, const RayDepth& rays, const NormalConfig& normals,
                        const MeanConfig& config) {
  std::vector<const SurfacePatch*> usable;
  for (const SurfacePatch& patch : patches) {
    if (patch.depth_mm.width() == rays.width && patch.depth_mm.height() == rays.height) usable.push_back(&patch);
  }
  SurfacePatch out;
  if (usable.empty()) return out;
  if (usable.size() == 1) return *usable.front();
  out.depth_mm = Map<float>(rays.width, rays.height, kNoDepth);
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(rays.width, rays.height, Vec3f::Constant(kNoDepth));
  out.normals = out.points;
  const auto textured = std::ranges::find_if(usable, [](const SurfacePatch* p) { return !p->texture_dn.empty(); });
  if (textured != usable.end()) out.texture_dn = (*textured)->texture_dn;
  Map<float> inverse_depth = out.depth_mm;
  const auto min_agreeing = static_cast<std::size_t>(std::max(1, config.min_agreeing));
  std::vector<Measured> at;
  for (std::size_t i = 0; i < out.depth_mm.size(); ++i) {
    at.clear();
    for (const SurfacePatch* patch : usable) {
      if (!std::isnan(patch->depth_mm[i])) at.push_back({patch->depth_mm[i], patch->sigma_mm[i]});
    }
    if (at.empty()) continue;
    const Measured mean = mean_of(at, static_cast<float>(config.gate_sigmas), std::min(min_agreeing, usable.size()));
    if (std::isnan(mean.depth_mm)) continue;
    out.depth_mm[i] = mean.depth_mm;
    out.sigma_mm[i] = mean.sigma_mm;
    out.points[i] = {rays.rays.x[i] * mean.depth_mm, rays.rays.y[i] * mean.depth_mm, mean.depth_mm};
    inverse_depth[i] = 1 / mean.depth_mm;
    ++out.valid_px;
  }
  std::vector<float> scratch;
  compute_normals(rays, inverse_depth, out.sigma_mm, normals, scratch, out.normals);
  return out;
}

}  // namespace enamel::pipeline
