#include "pipeline/algo/decode/micro_view.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/algo/decode/surface.hpp"
#include "pipeline/algo/phase/micro_spans.hpp"

namespace enamel::algo {
namespace {

constexpr std::size_t kRowValues = 4;       ///< residual and its columns of eps, light, gain
constexpr float kInformed_rad = 0.005F;     ///< sigma of a block's eps that can be asked whether it moved
constexpr float kSignificantSigmas = 2.0F;  ///< of a block's eps

}  // namespace

void MicroView::take_samples(const MotionField* known, MotionSamples& out) {
  const int columns = in_.maps.phase_rad.width();
  const auto width = static_cast<std::size_t>(columns);
  place_samples(columns, in_.maps.phase_rad.height(), out);
  GridRows rate(known != nullptr ? known->rate_grid() : Grid{}, columns);
  GridRows light(known != nullptr ? known->light_grid() : Grid{}, columns);
  GridRows rate_change(known != nullptr ? known->rate_change_grid() : Grid{}, columns);
  GridRows light_change(known != nullptr ? known->light_change_grid() : Grid{}, columns);
  // One gain for all: that of a block takes up half of what light does there.
  const std::vector<float> gain(width, in_.blocks.gain);
  std::vector<float> rows(kRowValues * width);
  float* r = rows.data();
  each_code_row(in_.spans, in_.turn, in_.code, [&](std::int32_t v, const float* cosine, const float* sine) {
    if (v % kPixelStep != 0) return;
    const std::size_t at = static_cast<std::size_t>(v) * width;
    CodeRow row = code_row_of(in_.blocks, in_.code, in_.third_rad, at, cosine, sine);
    if (known != nullptr) {
      row.motion_rad = rate.row(v), row.light = light.row(v);
      row.motion_change_rad = rate_change.row(v), row.light_change = light_change.row(v);
    }
    row.gain = gain.data();
    code_residual_row(in_.maps, row, at, width, {r, r + width, r + 2 * width, r + 3 * width});
    for (std::size_t u = 0; u < width; ++u)
      if (cosine[u] == 0 && sine[u] == 0) r[u] = std::nanf("");
    take_sample_row(in_.maps, v, {r, r + width, r + 2 * width, r + 3 * width, row.motion_rad, row.light, 0, 1},
                    in_.max_residual, out);
  });
}

void MicroView::make_images(const MotionField* known, MotionImages& out) {
  const int width = in_.maps.phase_rad.width(), height = in_.maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width);
  out.inverse_depth.resize(width, height);
  out.light.resize(width, height);
  out.phase.resize(columns);
  out.row.resize(columns);
  const std::size_t half = (columns + 1) / 2;
  const auto thin = [half](std::vector<float>& row) {
    for (std::size_t k = 0; k < half; ++k) row[k] = row[2 * k];
  };
  const MicroMotion& b = in_.blocks;
  const Grid blocks{b.block_motion_rad.data(), b.columns, b.rows, b.block_px};
  GridRows rate(known != nullptr ? known->rate_grid() : blocks, width);
  GridRows light(known != nullptr ? known->light_grid() : Grid{}, width);
  GridRows rate_change(known != nullptr ? known->rate_change_grid() : Grid{}, width);
  GridRows light_change(known != nullptr ? known->light_change_grid() : Grid{}, width);
  for (int v = 0; v < height; v += 2) {
    const std::size_t at = in_.maps.phase_rad.index(0, v);
    CodeRow row{};
    row.motion_rad = rate.row(v), row.light = light.row(v), row.black_dn = b.black_dn;
    row.motion_change_rad = rate_change.row(v), row.light_change = light_change.row(v);
    mid_burst_row(in_.maps, row, at, columns, out.phase.data(), out.row.data());
    for (float& a : out.row) a -= b.black_dn;
    thin(out.row), thin(out.phase);
    out.light.set_row(v / 2, out.row.data());
    sparse_inverse_depth_row(in_.maps, in_.turn, in_.rays, at, out.phase.data(), out.row.data());
    out.inverse_depth.set_row(v / 2, out.row.data());
  }
}

float MicroView::block_rate(int u, int v) const {
  const MicroMotion& b = in_.blocks;
  return b.block_motion_rad[static_cast<std::size_t>((v / b.block_px) * b.columns + u / b.block_px)];
}

bool stands_still(const MicroMotion& blocks, float negligible_rad) {
  std::size_t seen = 0, moving = 0;
  for (std::size_t k = 0; k < blocks.block_motion_rad.size(); ++k) {
    if (!(blocks.block_sigma_rad[k] < kInformed_rad)) continue;
    ++seen;
    const float limit = negligible_rad + kSignificantSigmas * blocks.block_sigma_rad[k];
    moving += std::abs(blocks.block_motion_rad[k]) > limit ? 1U : 0U;
  }
  return seen > 0 && 4 * moving < seen;
}

void spread_motion(const MotionField& field, MicroMotion& out) {
  interpolate_grid(field.rate_grid(), out.pixel_motion_rad);
  interpolate_grid(field.light_grid(), out.pixel_light);
  interpolate_grid(field.rate_change_grid(), out.pixel_motion_change_rad);
  interpolate_grid(field.light_change_grid(), out.pixel_light_change);
}

}  // namespace enamel::algo
