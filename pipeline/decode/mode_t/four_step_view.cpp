#include "pipeline/decode/mode_t/four_step_view.hpp"

#include "pipeline/decode/mode_t/closure_sample_rows.hpp"
#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/triangulate/inverse_depth.hpp"

namespace enamel::pipeline {

void FourStepView::take_samples(const MotionField* known, MotionSamples& out) {
  place_samples(in_.maps.phase_rad.width(), in_.maps.phase_rad.height(), out);
  if (known == nullptr) return take_samples_at_rest(out);
  take_samples_about(*known, out);
}

void FourStepView::take_samples_at_rest(MotionSamples& out) {
  pixels_.sampled.take(in_.maps, in_.polarity, out);
  for (int v = 0; v < in_.maps.phase_rad.height(); v += kPixelStep) {
    const SampledRow pixels = pixels_.sampled.row(v);
    if (pixels.count == 0) continue;
    const SampledResiduals row = sampled_residuals(pixels.count, out);
    closure_sample_row(pixels, in_.black_dn, in_.max_residual, row);
    put_sampled_residuals(in_.maps.phase_rad.width(), v, row, true, out);
  }
}

void FourStepView::take_samples_about(const MotionField& known, MotionSamples& out) {
  const int width = in_.maps.phase_rad.width();
  ErrorRows rows(errors_of(known), in_.black_dn, width);
  GatheredErrors gathered;
  RowMemory row(4 * static_cast<std::size_t>(width));
  for (int v = 0; v < in_.maps.phase_rad.height(); v += kPixelStep) {
    const SampledRow p = pixels_.sampled.row(v);
    if (p.count == 0) continue;
    const RowErrors e = gathered.of(rows.at(in_.polarity, v), p.weight, p.runs);
    float* r = row.data();
    const LeftRow left{r, r + p.count, r + 2 * p.count, r + 3 * p.count};
    left_row({p.cosine, p.sine, p.code, p.mean, p.phase, e}, p.count, left);
    take_sample_row(
        width, v, {left.residual, left.by_rate, left.by_light, left.by_harmonic, e.rate, e.light, p.modulation, p.open},
        in_.max_residual, out);
  }
}

void FourStepView::make_images(const MotionField* known, MotionImages& out) {
  const int width = in_.maps.phase_rad.width(), height = in_.maps.phase_rad.height();
  const auto columns = static_cast<std::size_t>(width + 1) / 2;
  out.resize(width, height);
  if (!has_images_) pixels_.sparse.take(in_.maps, in_.polarity);
  has_images_ = true;
  ErrorRows rows(known != nullptr ? errors_of(*known) : in_.blocks.errors(), in_.black_dn, width, {0, kSparseStep});
  for (int v = 0; v < height; v += 2) {
    mid_burst_row(pixels_.sparse.row(rows, v), columns, out.phase.data(), out.light_row.data());
    out.light.set_row(v / 2, out.light_row.data());
    sparse_inverse_depth_row({in_.maps, in_.polarity.wraps, in_.rays}, v, out.phase.data(), out.row.data());
    out.inverse_depth.set_row(v / 2, out.row.data());
  }
}

float FourStepView::block_rate(int u, int v) const { return in_.blocks.block_motion_rad[in_.blocks.block_at(u, v)]; }

}  // namespace enamel::pipeline
