// Mode M's view of motion: what the code frame shows beyond the prediction of the other three (micro_refit.hpp).
// Private to pipeline/decode.
#pragma once

#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/motion/motion_view.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"

namespace enamel::pipeline {

struct MicroViewInput {
  const Map<std::int16_t>& wraps;          ///< of pixels that are asked for the motion
  const Map<std::int16_t>& surface_wraps;  ///< of pixels that slopes are taken from
  float beyond;                            ///< these may lie out of the depth range by this share of its ends
  const MicroCode& code;
  float third_rad;
  const PhaseMaps& maps;  ///< as fit_micro_motion takes them
  const RayDepth& rays;
  const MicroMotion& blocks;
  float max_residual;    ///< of B
  bool orders_are_sure;  ///< else no block's own motion counts: a wrong order is explained by a wrong one
};

/// All borrowed. Without motion known, residuals and their columns are about that of the blocks.
class MicroView final : public MotionView {
 public:
  explicit MicroView(const MicroViewInput& input) : in_(input) {}

  void take_samples(const MotionField* known, MotionSamples& out) override;
  void make_images(const MotionField* known, MotionImages& out) override;
  [[nodiscard]] float block_rate(int u, int v) const override;

 private:
  [[nodiscard]] SurfaceMotion motion(const MotionField* known) const;
  MicroViewInput in_;
};

/// The field as micro_refit.hpp takes it. Borrowed.
[[nodiscard]] SurfaceMotion surface_motion(const MotionField& field) noexcept;

}  // namespace enamel::pipeline
