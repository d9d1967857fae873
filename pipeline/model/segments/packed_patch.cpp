#include "pipeline/model/segments/packed_patch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

constexpr float kTextureSteps = 16;  // a DN

}  // namespace

PackedPatch pack(const SurfacePatch& patch) {
  PackedPatch out;
  out.width = patch.depth_mm.width();
  out.height = patch.depth_mm.height();
  out.depth_mm.reserve(patch.valid_px);
  out.sigma_mm.reserve(patch.valid_px);
  for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
    if (std::isnan(patch.depth_mm[i])) continue;
    if (out.runs.empty() || out.runs.back().begin + out.runs.back().count != i)
      out.runs.push_back({static_cast<std::uint32_t>(i), 0});
    ++out.runs.back().count;
    out.depth_mm.push_back(patch.depth_mm[i]);
    out.sigma_mm.push_back(patch.sigma_mm[i]);
  }
  out.texture.reserve(patch.texture_dn.size());
  for (const float dn : patch.texture_dn.pixels()) {
    const float steps = std::isnan(dn) ? 0.0F : dn * kTextureSteps + 0.5F;
    out.texture.push_back(static_cast<std::uint16_t>(std::clamp(steps, 0.0F, 65535.0F)));
  }
  return out;
}

SurfacePatch Unpacker::operator()(const PackedPatch& packed) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SurfacePatch out;
  out.depth_mm = Map<float>(packed.width, packed.height, kNan);
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(packed.width, packed.height, Vec3f::Constant(kNan));
  out.normals = out.points;
  out.texture_dn = Map<float>(packed.width, packed.height);
  out.valid_px = packed.depth_mm.size();
  Map<float> inverse_depth = out.depth_mm;
  std::size_t n = 0;
  for (const PackedPatch::Run& run : packed.runs) {
    for (std::size_t i = run.begin; i < std::size_t{run.begin} + run.count; ++i, ++n) {
      const float z = packed.depth_mm[n];
      out.depth_mm[i] = z;
      out.sigma_mm[i] = packed.sigma_mm[n];
      out.points[i] = {rays_->rays.x[i] * z, rays_->rays.y[i] * z, z};
      inverse_depth[i] = 1 / z;
    }
  }
  for (std::size_t i = 0; i < packed.texture.size(); ++i)
    out.texture_dn[i] = static_cast<float>(packed.texture[i]) / kTextureSteps;
  std::vector<float> scratch;
  compute_normals(*rays_, inverse_depth, out.sigma_mm, normals_, scratch, out.normals);
  return out;
}

}  // namespace enamel::pipeline
