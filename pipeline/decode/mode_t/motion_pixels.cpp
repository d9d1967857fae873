#include "pipeline/decode/mode_t/motion_pixels.hpp"

#include "pipeline/decode/motion/motion_samples.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
void SampledPixels::take(const PhaseMaps& maps, const PolarityMaps& polarity, const MotionSamples& samples) {
  const int width = maps.phase_rad.width(), height = maps.phase_rad.height();
  runs_.clear();
  begin_.clear();
  std::size_t pixels = 0;
  for (int v = 0; v < height; v += kPixelStep) {
    runs_.push_back(runs_of_row(samples, width, v));
    begin_.push_back(pixels);
    pixels += runs_.back().pixels();
  }
  for (auto* a : {&cosine_, &sine_, &code_, &mean_, &phase_, &weight_, &modulation_, &open_}) a->resize(pixels);
  for (int v = 0; v < height; v += kPixelStep) {
    const auto y = static_cast<std::size_t>(v / kPixelStep);
    const GatheredRuns& runs = runs_[y];
    if (runs.count == 0) continue;
    const std::size_t at = maps.phase_rad.index(0, v), to = begin_[y];
    gather_row(&maps.cosine_dn[at], runs, &cosine_[to]), gather_row(&maps.sine_dn[at], runs, &sine_[to]);
    gather_row(&maps.code_dn[at], runs, &code_[to]), gather_row(&maps.mean_dn[at], runs, &mean_[to]);
    gather_row(&maps.phase_rad[at], runs, &phase_[to]), gather_row(&polarity.weight[at], runs, &weight_[to]);
    gather_row(&maps.modulation_dn[at], runs, &modulation_[to]);
    gather_open(&maps.reject[at], runs, &open_[to]);
  }
}

SampledRow SampledPixels::row(int v) const {
  const auto y = static_cast<std::size_t>(v / kPixelStep);
  const std::size_t i = begin_[y];
  return {runs_[y].pixels(), runs_[y],          cosine_.data() + i, sine_.data() + i,       code_.data() + i,
          mean_.data() + i,  phase_.data() + i, weight_.data() + i, modulation_.data() + i, open_.data() + i};
}

}  // namespace enamel::pipeline
