// Mode T's view of motion: the closure residual (closure.hpp). Private to algo/decode.
#pragma once

#include "pipeline/algo/decode/motion_view.hpp"
#include "pipeline/algo/phase/closure.hpp"
#include "pipeline/algo/phase/polarity.hpp"

namespace enamel::algo {

/// Valid while `field` lives. The harmonic is the one solved together with the motion: that of the blocks takes up what
/// light sliding by leaves in the closure, wherever the b = +1 cells of a block are no whole fringe.
[[nodiscard]] inline BurstErrors errors_of(const MotionField& field) noexcept {
  return {field.rate_grid(), field.shared_grid(), field.light_grid(), field.rate_change_grid(),
          field.light_change_grid()};
}

/// maps, polarity: after apply_polarity; all borrowed.
class FourStepView final : public MotionView {
 public:
  FourStepView(const PhaseMaps& maps, const PolarityMaps& polarity, const ClosureFit& coarse, const RayDepth& rays,
               float black_dn, float max_residual)
      : maps_(maps),
        polarity_(polarity),
        coarse_(coarse),
        rays_(rays),
        black_dn_(black_dn),
        max_residual_(max_residual) {}

  void take_samples(const MotionField* known, MotionSamples& out) override {
    if (known == nullptr) {
      algo::take_samples(maps_, polarity_, black_dn_, max_residual_, out);
    } else {
      algo::take_samples(maps_, polarity_, errors_of(*known), black_dn_, max_residual_, out);
    }
  }
  void make_images(const MotionField* known, MotionImages& out) override {
    make_motion_images(maps_, polarity_, rays_, known != nullptr ? errors_of(*known) : coarse_.errors(), black_dn_,
                       seen_, out);
    seen_ = true;
  }
  [[nodiscard]] float block_rate(int u, int v) const override {
    return coarse_.block_motion_rad[coarse_.block_at(u, v)];
  }

 private:
  const PhaseMaps& maps_;
  const PolarityMaps& polarity_;
  const ClosureFit& coarse_;
  const RayDepth& rays_;
  float black_dn_, max_residual_;
  bool seen_ = false;  ///< images were made before, which hold what the burst shows
};

}  // namespace enamel::algo
