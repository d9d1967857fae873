#include "pipeline/model/segments/packed_patch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

namespace enamel::pipeline {
namespace {

constexpr float kTextureSteps = 16;  // a DN
constexpr float kSigmaUnit_mm = 1e-4F;
constexpr float kSigmaSteps = 16;  // an octave; 255 of them reach 6 mm

std::uint8_t sigma_code(float sigma_mm) {
  return static_cast<std::uint8_t>(std::clamp(kSigmaSteps * std::log2(sigma_mm / kSigmaUnit_mm) + 0.5F, 0.0F, 255.0F));
}

/// sigma_code() without its logarithm, which cost more than all else that is done to a pixel: the floats of one leading
/// five bits of fraction reach two codes at most.
class SigmaCodes {
 public:
  SigmaCodes() {
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t first = (kFirst + i) << kShift, last = first + (1U << kShift) - 1;
      cells_[i] = {first_float_above(first, last), sigma_code(std::bit_cast<float>(first))};
    }
  }
  [[nodiscard]] std::uint8_t operator()(float sigma_mm) const {
    const std::uint32_t at = std::bit_cast<std::uint32_t>(sigma_mm) >> kShift;
    const Cell& cell = cells_[std::clamp(at, kFirst, kFirst + kCells - 1) - kFirst];
    return static_cast<std::uint8_t>(cell.code + (sigma_mm >= cell.next_from_mm ? 1 : 0));
  }

 private:
  struct Cell {
    float next_from_mm = 0;  ///< from here on the next code
    std::uint8_t code = 0;
  };
  static constexpr std::uint32_t kShift = 18;                                               // five bits of fraction
  static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(6.0e-5F) >> kShift;  // below code 1
  static constexpr std::uint32_t kCells = (std::bit_cast<std::uint32_t>(8.0F) >> kShift) - kFirst;  // beyond code 255

  /// Both as bits.
  static float first_float_above(std::uint32_t first, std::uint32_t last) {
    const std::uint8_t code = sigma_code(std::bit_cast<float>(first));
    if (sigma_code(std::bit_cast<float>(last)) == code) return std::numeric_limits<float>::infinity();
    while (last - first > 1) {
      const std::uint32_t middle = first + (last - first) / 2;
      (sigma_code(std::bit_cast<float>(middle)) == code ? first : last) = middle;
    }
    return std::bit_cast<float>(last);
  }

  std::array<Cell, kCells> cells_{};
};

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

/// Of all that is known: nearest and farthest, and how many.
struct DepthRange {
  float nearest = std::numeric_limits<float>::max(), farthest = 0;
  std::size_t known = 0;
};

DepthRange range_of(std::span<const float> depth) {
  constexpr std::size_t kLanes = 8;  // each with its own range: a compiler takes them side by side
  std::array<float, kLanes> nearest{}, farthest{};
  std::array<std::uint32_t, kLanes> known{};
  DepthRange out;
  nearest.fill(out.nearest);
  const auto look = [&](float z, std::size_t k) {
    nearest[k] = z < nearest[k] ? z : nearest[k];  // false for NaN
    farthest[k] = z > farthest[k] ? z : farthest[k];
    known[k] += z == z ? 1U : 0U;
  };
  const std::size_t whole = depth.size() / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) look(depth[i + k], k);
  }
  for (std::size_t i = whole; i < depth.size(); ++i) look(depth[i], 0);
  for (std::size_t k = 0; k < kLanes; ++k) {
    out.nearest = std::min(out.nearest, nearest[k]);
    out.farthest = std::max(out.farthest, farthest[k]);
    out.known += known[k];
  }
  return out;
}

std::vector<PackedPatch::Run> runs_of(std::span<const float> depth) {
  std::vector<PackedPatch::Run> out;
  out.reserve(depth.size() / 64);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (std::isnan(depth[i])) continue;
    const std::size_t begin = i;
    while (i < depth.size() && !std::isnan(depth[i])) ++i;
    out.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(i - begin)});
  }
  return out;
}

void pack_texture(std::span<const float> texture, std::vector<std::uint16_t>& out) {
  out.reserve(texture.size());
  for (const float dn : texture) {
    const float steps = std::isnan(dn) ? 0.0F : dn * kTextureSteps + 0.5F;
    out.push_back(static_cast<std::uint16_t>(std::clamp(steps, 0.0F, 65535.0F)));
  }
}

}  // namespace

PackedPatch pack(const SurfacePatch& patch, Texture texture) {
  static const SigmaCodes kCode;
  PackedPatch out;
  out.width = patch.depth_mm.width();
  out.height = patch.depth_mm.height();
  const std::span<const float> depth = patch.depth_mm.pixels();
  const DepthRange range = range_of(depth);
  out.nearest_mm = range.nearest;
  out.step_mm = std::max(range.farthest - range.nearest, 1e-3F) / 65535.0F;
  out.runs = runs_of(depth);
  out.shade = patch.shade;
  out.depth.resize(range.known);
  out.sigma.resize(range.known);
  std::uint16_t* steps = out.depth.data();
  std::uint8_t* codes = out.sigma.data();
  const float nearest = out.nearest_mm, step = out.step_mm;
  for (const PackedPatch::Run& run : out.runs) {
    const float* z = &depth[run.begin];
    const float* sigma = &patch.sigma_mm[run.begin];
    for (std::uint32_t i = 0; i < run.count; ++i)
      steps[i] =
          static_cast<std::uint16_t>(static_cast<std::int32_t>(std::min((z[i] - nearest) / step + 0.5F, 65535.0F)));
    for (std::uint32_t i = 0; i < run.count; ++i) codes[i] = kCode(sigma[i]);
    steps += run.count;
    codes += run.count;
  }
  if (texture == Texture::kKept) pack_texture(patch.texture_dn.pixels(), out.texture);
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
  out.shade = packed.shade;
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
