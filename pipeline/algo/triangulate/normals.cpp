#include "pipeline/algo/triangulate/normals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/algo/triangulate/interleave.hpp"
#include "pipeline/algo/triangulate/normal_rows.hpp"

namespace enamel::algo {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The last seven rows of 1/z in a frame of NaN, so that the loop needs no borders; behind them, a row of components.
class Ring {
 public:
  Ring(const Map<float>& inverse_depth, std::vector<float>& memory)
      : map_(inverse_depth), memory_(memory), pitch_(static_cast<std::size_t>(map_.width() + 2 * kNormalReach_px)) {
    memory_.assign(kRows * pitch_ + 3 * static_cast<std::size_t>(map_.width()), kNan);
  }

  /// Row v, which may lie beyond the image; replaces row v - 7.
  void load(int v) {
    float* row = begin_of(v);
    const auto width = static_cast<std::size_t>(map_.width());
    if (v < map_.height()) std::copy_n(&map_[static_cast<std::size_t>(v) * width], width, row);
    if (v >= map_.height()) std::fill_n(row, width, kNan);
  }

  [[nodiscard]] NormalWindow around(int v) {
    NormalWindow window{};
    for (int k = 0; k < kRows; ++k) window[static_cast<std::size_t>(k)] = begin_of(v + k - kNormalReach_px);
    return window;
  }

  [[nodiscard]] NormalRow components() {
    const auto width = static_cast<std::size_t>(map_.width());
    float* x = memory_.data() + kRows * pitch_;
    return {x, x + width, x + 2 * width};
  }

 private:
  static constexpr int kRows = 2 * kNormalReach_px + 1;

  float* begin_of(int v) {
    return memory_.data() + static_cast<std::size_t>((v + kRows) % kRows) * pitch_ + kNormalReach_px;
  }

  const Map<float>& map_;
  std::vector<float>& memory_;
  std::size_t pitch_;
};

}  // namespace

void compute_normals(const RayDepth& rays, const Map<float>& inverse_depth, const Map<float>& sigma_mm,
                     const NormalConfig& config, std::vector<float>& scratch, Map<Vec3f>& normals) {
  const int w = inverse_depth.width(), h = inverse_depth.height();
  const auto row = static_cast<std::size_t>(w);
  if (normals.width() != w || normals.height() != h) normals = Map<Vec3f>(w, h, Vec3f::Zero());
  if (w < 2 || h < 2) {  // a line of pixels spans no plane
    std::fill(normals.pixels().begin(), normals.pixels().end(), Vec3f::Constant(kNan));
    return;
  }
  const std::size_t centre = inverse_depth.index(std::min(w / 2, w - 2), std::min(h / 2, h - 2));
  const float px_x = rays.rays.x[centre + 1] - rays.rays.x[centre];
  const float px_y = rays.rays.y[centre + row] - rays.rays.y[centre];
  const auto slope = static_cast<float>(std::tan(static_cast<double>(config.max_slope_deg) * std::numbers::pi / 180));
  Ring ring(inverse_depth, scratch);
  for (int v = 0; v < kNormalReach_px; ++v) ring.load(v);
  for (int v = 0; v < h; ++v) {
    ring.load(v + kNormalReach_px);
    const std::size_t at = static_cast<std::size_t>(v) * row;
    const NormalRow n = ring.components();
    normals_of_row(ring.around(v), &sigma_mm[at], {&rays.rays.x[at], &rays.rays.y[at], px_x, px_y, slope}, w, n);
    interleave(n.x, n.y, n.z, row, normals[at].data());
  }
}

}  // namespace enamel::algo
