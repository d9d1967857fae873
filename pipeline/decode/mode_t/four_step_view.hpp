// Mode T's view of motion: the closure residual (closure.hpp). Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/closure_rows.hpp"
#include "pipeline/decode/mode_t/motion_pixels.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/motion/motion_view.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

/// Valid while `field` lives. The harmonic is the one solved together with the motion: that of the blocks takes up what
/// light sliding by leaves in the closure, wherever the b = +1 cells of a block are no whole fringe.
[[nodiscard]] inline BurstErrors errors_of(const MotionField& field) noexcept {
  return {field.rate_grid(), field.shared_grid(), field.light_grid(), field.rate_change_grid(),
          field.light_change_grid()};
}

/// What the view brings together once a burst: each pass over the motion asks for it. Keeps its memory.
struct FourStepPixels {
  SampledPixels sampled;  ///< that the motion is judged by
  SparsePixels sparse;    ///< that slopes are taken from
};

/// What mode T knows of a burst before its motion: maps and polarity after apply_polarity, blocks of fit_closure. All
/// borrowed.
struct FourStepViewInput {
  const PhaseMaps& maps;
  const PolarityMaps& polarity;
  const ClosureFit& blocks;
  const RayDepth& rays;
  float black_dn;
  float max_residual;  ///< of B
};

class FourStepView final : public MotionView {
 public:
  FourStepView(const FourStepViewInput& input, FourStepPixels& pixels) : in_(input), pixels_(pixels) {}

  void take_samples(const MotionField* known, MotionSamples& out) override;
  void make_images(const MotionField* known, MotionImages& out) override;
  [[nodiscard]] float block_rate(int u, int v) const override;

 private:
  void take_samples_at_rest(MotionSamples& out);
  void take_samples_about(const MotionField& known, MotionSamples& out);

  FourStepViewInput in_;
  FourStepPixels& pixels_;
  bool has_images_ = false;  ///< `sparse` holds what the burst shows
};

}  // namespace enamel::pipeline
