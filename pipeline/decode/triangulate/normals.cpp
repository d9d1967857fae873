#include "pipeline/decode/triangulate/normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/decode/triangulate/interleave.hpp"
#include "pipeline/decode/triangulate/normal_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr int kRows = 2 * kNormalReach_px + 1;  ///< layout: of a window

}  // namespace

NormalRows::NormalRows(const RayDepth& rays, const NormalConfig& config, std::vector<float>& memory)
    : rays_(rays),
      memory_(memory),
      pitch_(static_cast<std::size_t>(rays.width + 2 * kNormalReach_px)),
      max_slope_(static_cast<float>(std::tan(static_cast<double>(config.max_slope_deg) * std::numbers::pi / 180))) {
  const auto width = static_cast<std::size_t>(rays.width);
  memory_.assign(kRows * pitch_ + 3 * width, kNan);
  if (!spans_a_plane()) return;
  const auto u = static_cast<std::size_t>(std::min(rays.width / 2, rays.width - 2));
  const std::size_t centre = static_cast<std::size_t>(std::min(rays.height / 2, rays.height - 2)) * width + u;
  per_px_x_ = rays.rays.x[centre + 1] - rays.rays.x[centre];
  per_px_y_ = rays.rays.y[centre + width] - rays.rays.y[centre];
}

bool NormalRows::spans_a_plane() const noexcept { return rays_.width >= 2 && rays_.height >= 2; }

float* NormalRows::row(int v) {
  return memory_.data() + static_cast<std::size_t>((v + kRows) % kRows) * pitch_ + kNormalReach_px;
}

void NormalRows::added(int v, const Map<float>& sigma_mm, Map<Vec3f>& normals) {
  const auto width = static_cast<std::size_t>(rays_.width);
  const int done = v - kNormalReach_px;
  if (done >= 0) solve(done, &sigma_mm[static_cast<std::size_t>(done) * width], normals);
  if (v + 1 < rays_.height) return;
  for (int beyond = v + 1; beyond <= v + kNormalReach_px; ++beyond) {
    std::fill_n(row(beyond), width, kNan);
    const int last = beyond - kNormalReach_px;
    if (last >= 0) solve(last, &sigma_mm[static_cast<std::size_t>(last) * width], normals);
  }
}

void NormalRows::solve(int v, const float* sigma_mm, Map<Vec3f>& normals) {
  const auto width = static_cast<std::size_t>(rays_.width);
  const std::size_t at = static_cast<std::size_t>(v) * width;
  if (!spans_a_plane()) {
    std::fill_n(&normals[at], width, Vec3f::Constant(kNan));
    return;
  }
  NormalWindow window{};
  for (int k = 0; k < kRows; ++k) window[static_cast<std::size_t>(k)] = row(v + k - kNormalReach_px);
  float* x = memory_.data() + kRows * pitch_;
  const NormalRow out{x, x + width, x + 2 * width};
  normals_of_row(window, sigma_mm, {&rays_.rays.x[at], &rays_.rays.y[at], per_px_x_, per_px_y_, max_slope_},
                 rays_.width, out);
  interleave(out.x, out.y, out.z, width, normals[at].data());
}

void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals) {
  const int w = inverse_depth.width(), h = inverse_depth.height();
  if (normals.width() != w || normals.height() != h) normals = Map<Vec3f>(w, h, Vec3f::Zero());
  NormalRows rows(rays, config, scratch);
  for (int v = 0; v < h; ++v) {
    std::copy_n(&inverse_depth(0, v), w, rows.row(v));
    rows.added(v, sigma_mm, normals);
  }
}

}  // namespace enamel::pipeline
