#include "pipeline/algo/triangulate/normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/algo/phase/poly_trig.hpp"
#include "pipeline/algo/triangulate/normal_rows.hpp"

namespace enamel::algo {
namespace {

/// A ring of radius 3 (lever arm against noise) and the four-neighbours (something to go by beside an edge).
constexpr std::array<PixelOffset, 10> kPairs = {
    {{1, 0}, {0, 1}, {3, 0}, {0, 3}, {2, 2}, {2, -2}, {3, 1}, {1, 3}, {3, -1}, {1, -3}}};

}  // namespace

void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals) {
  const int w = inverse_depth.width(), h = inverse_depth.height();
  const auto row = static_cast<std::size_t>(w);
  if (normals.width() != w || normals.height() != h) normals = Map<Vec3f>(w, h, Vec3f::Zero());
  if (w < 2 || h < 2) {  // a line of pixels spans no plane
    std::fill(normals.pixels().begin(), normals.pixels().end(),
              Vec3f::Constant(std::numeric_limits<float>::quiet_NaN()));
    return;
  }
  scratch.resize(6 * row);
  const NormalSums sums{scratch.data(), &scratch[row], &scratch[2 * row], &scratch[3 * row], &scratch[4 * row]};
  float* limit = &scratch[5 * row];
  const std::size_t centre = inverse_depth.index(std::min(w / 2, w - 2), std::min(h / 2, h - 2));
  const float px_x = rays.rays.x[centre + 1] - rays.rays.x[centre];
  const float px_y = rays.rays.y[centre + row] - rays.rays.y[centre];
  const auto slope = static_cast<float>(std::tan(static_cast<double>(config.max_slope_deg) * std::numbers::pi / 180));
  for (int v = 0; v < h; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * row;
    std::fill_n(scratch.begin(), 5 * row, 0.0F);
    const float* q = &inverse_depth[at];
    const float* sigma = &sigma_mm[at];
    // A pixel's step on a surface of that slope, and 4 sigma of a difference, both as change of 1/z.
    for (std::size_t u = 0; u < row; ++u) limit[u] = q[u] * (slope * px_x + 5.7F * sigma[u] * q[u]);
    for (const PixelOffset o : kPairs) {
      if (v - std::abs(o.dv) < 0 || v + std::abs(o.dv) >= h) continue;
      const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(o.dv) * w + o.du;
      add_normal_pair(q + step, q - step, limit, o, std::abs(o.du), w - std::abs(o.du), sums);
    }
    solve_normal_row(sums, q, {&rays.rays.x[at], &rays.rays.y[at], px_x, px_y}, w, &normals[at]);
  }
}

}  // namespace enamel::algo
