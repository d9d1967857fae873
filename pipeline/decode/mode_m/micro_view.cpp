#include "pipeline/decode/mode_m/micro_view.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/triangulate/inverse_depth.hpp"

namespace enamel::pipeline {
namespace {

/// The sampled pixels of a row, brought together.
class Gathered {
 public:
  /// From row v, as motion_samples.hpp places them; returns their number.
  std::size_t choose(const MotionSamples& samples, int width, int v) {
    const int columns = width / kNode_px;
    first_.clear();
    for (const std::int32_t node : nodes_of_row(samples, columns, v / kNode_px))
      first_.push_back(node % columns * kNode_px + first_column(v));
    return kPerNode * first_.size();
  }

  /// Valid until the next call. What is 0 in a steady row is left out, and modulation.
  [[nodiscard]] CodeRow of(CodeRow row) {
    values_.resize(kSources * kPerNode * first_.size());
    float* next = values_.data();
    CodePixels& p = row.pixels;
    const auto take = [&](const float*& source) {
      const float* from = std::exchange(source, next);
      for (const int column : first_) {
        for (std::size_t k = 0; k < kPerNode; ++k) next[k] = from[static_cast<std::size_t>(column) + k * kPixelStep];
        next += kPerNode;
      }
    };
    for (auto* source : {&p.mean, &p.cosine, &p.sine, &p.code, &p.phase, &row.wraps, &row.motion_rad, &row.gain})
      take(*source);
    if (!row.steady) take(row.light), take(row.motion_change_rad), take(row.light_change);
    return row;
  }

 private:
  static constexpr std::size_t kSources = 11, kPerNode = kNode_px / kPixelStep;  ///< layout: rows
  std::vector<int> first_;                                                       ///< of each node's pixels
  std::vector<float> values_;
};

}  // namespace

SurfaceMotion MicroView::motion(const MotionField* known) const {
  return known != nullptr ? surface_motion(*known) : in_.blocks.everywhere();
}

void MicroView::take_samples(const MotionField* known, MotionSamples& out) {
  const int width = in_.maps.phase_rad.width();
  place_samples(width, in_.maps.phase_rad.height(), out);
  // One gain for all: that of a block takes up half of what light does there.
  CodeRows rows(motion(known), {&in_.blocks.gain, 1, 1, in_.blocks.block_px}, in_.blocks.black_dn, in_.maps,
                &in_.wraps);
  rows.expect(in_.code, in_.third_rad);
  Gathered gathered;
  std::vector<float> values, modulation, open;
  for (int v = 0; v < in_.maps.phase_rad.height(); v += kPixelStep) {
    const std::size_t count = gathered.choose(out, width, v);
    if (count == 0) continue;
    values.resize(4 * count);
    float* r = values.data();
    const CodeRow row = gathered.of(rows.at(v));
    code_residual_row(row, count, {r, r + count, r + 2 * count, r + 3 * count});
    const std::size_t at = in_.maps.phase_rad.index(0, v);
    const GatheredRuns runs = runs_of_row(out, width, v);
    modulation.resize(count), open.resize(count);
    gather_row(&in_.maps.modulation_dn[at], runs, modulation.data());
    gather_open(&in_.maps.reject[at], runs, open.data());
    take_sample_row(width, v,
                    {.residual = r,
                     .rate = r + count,
                     .light = r + 2 * count,
                     .shared = r + 3 * count,
                     .known_rate = row.motion_rad,
                     .known_light = row.light,
                     .modulation = modulation.data(),
                     .open = open.data()},
                    in_.max_residual, out);
  }
}

void MicroView::make_images(const MotionField* known, MotionImages& out) {
  const int width = in_.maps.phase_rad.width(), height = in_.maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width + 1) / 2;
  out.resize(width, height);
  CodeRows rows(motion(known), {}, in_.blocks.black_dn, in_.maps, nullptr);
  for (int v = 0; v < height; v += 2) {
    sparse_mid_burst_row(rows.at(v), columns, out.phase.data(), out.row.data());
    out.light.set_row(v / 2, out.row.data());
    sparse_inverse_depth_row({in_.maps, in_.surface_wraps, in_.rays, in_.beyond}, v, out.phase.data(), out.row.data());
    out.inverse_depth.set_row(v / 2, out.row.data());
  }
}

float MicroView::block_rate(int u, int v) const {
  const MicroMotion& b = in_.blocks;
  const auto k = static_cast<std::size_t>((v / b.block_px) * b.columns + u / b.block_px);
  const bool tells = in_.orders_are_sure && b.block_sigma_rad[k] < kInformed_rad;
  return tells ? b.block_motion_rad[k] : std::numeric_limits<float>::quiet_NaN();
}

SurfaceMotion surface_motion(const MotionField& field) noexcept {
  return {field.rate_grid(), field.light_grid(), field.rate_change_grid(), field.light_change_grid()};
}

}  // namespace enamel::pipeline
