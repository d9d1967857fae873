#include "pipeline/model/segments/packed_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace enamel::pipeline {
namespace {

constexpr float kTextureSteps = 16;  // a DN
constexpr float kSigmaUnit_mm = 1e-4F;
constexpr float kSigmaSteps = 16;  // an octave; 255 of them reach 6 mm

std::uint8_t sigma_code(float sigma_mm) {
  return static_cast<std::uint8_t>(std::clamp(kSigmaSteps * std::log2(sigma_mm / kSigmaUnit_mm) + 0.5F, 0.0F, 255.0F));
}

/// Sigma of each code, by doubling alone where a library's exp2 might differ in its last bit.
std::array<float, 256> sigma_table() {
  std::array<float, 256> out{};
  constexpr double kStep = 1.0442737824274138;  // 2^(1/16)
  double value = static_cast<double>(kSigmaUnit_mm);
  for (float& sigma : out) {
    sigma = static_cast<float>(value);
    value *= kStep;
  }
  return out;
}

}  // namespace

PackedPatch pack(const SurfacePatch& patch, Texture texture) {
  PackedPatch out;
  out.width = patch.depth_mm.width();
  out.height = patch.depth_mm.height();
  float nearest = std::numeric_limits<float>::max(), farthest = 0;
  for (const float z : patch.depth_mm.pixels()) {
    if (std::isnan(z)) continue;
    nearest = std::min(nearest, z);
    farthest = std::max(farthest, z);
  }
  out.nearest_mm = nearest;
  out.step_mm = std::max(farthest - nearest, 1e-3F) / 65535.0F;
  out.depth.reserve(patch.valid_px);
  out.sigma.reserve(patch.valid_px);
  for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
    const float z = patch.depth_mm[i];
    if (std::isnan(z)) continue;
    if (out.runs.empty() || out.runs.back().begin + out.runs.back().count != i)
      out.runs.push_back({static_cast<std::uint32_t>(i), 0});
    ++out.runs.back().count;
    out.depth.push_back(static_cast<std::uint16_t>(std::min((z - nearest) / out.step_mm + 0.5F, 65535.0F)));
    out.sigma.push_back(sigma_code(patch.sigma_mm[i]));
  }
  if (texture == Texture::kDropped) return out;
  out.texture.reserve(patch.texture_dn.size());
  for (const float dn : patch.texture_dn.pixels()) {
    const float steps = std::isnan(dn) ? 0.0F : dn * kTextureSteps + 0.5F;
    out.texture.push_back(static_cast<std::uint16_t>(std::clamp(steps, 0.0F, 65535.0F)));
  }
  return out;
}

SurfacePatch Unpacker::operator()(const PackedPatch& packed) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  static const std::array<float, 256> kSigma_mm = sigma_table();
  SurfacePatch out;
  out.depth_mm = Map<float>(packed.width, packed.height, kNan);
  out.sigma_mm = out.depth_mm;
  out.points = Map<Vec3f>(packed.width, packed.height, Vec3f::Constant(kNan));
  out.normals = out.points;
  out.valid_px = packed.depth.size();
  Map<float> inverse_depth = out.depth_mm;
  std::size_t n = 0;
  for (const PackedPatch::Run& run : packed.runs) {
    for (std::size_t i = run.begin; i < std::size_t{run.begin} + run.count; ++i, ++n) {
      const float z = packed.nearest_mm + static_cast<float>(packed.depth[n]) * packed.step_mm;
      out.depth_mm[i] = z;
      out.sigma_mm[i] = kSigma_mm[packed.sigma[n]];
      out.points[i] = {rays_->rays.x[i] * z, rays_->rays.y[i] * z, z};
      inverse_depth[i] = 1 / z;
    }
  }
  if (!packed.texture.empty()) out.texture_dn = Map<float>(packed.width, packed.height);
  for (std::size_t i = 0; i < packed.texture.size(); ++i)
    out.texture_dn[i] = static_cast<float>(packed.texture[i]) / kTextureSteps;
  std::vector<float> scratch;
  compute_normals(*rays_, inverse_depth, out.sigma_mm, normals_, scratch, out.normals);
  return out;
}

}  // namespace enamel::pipeline
