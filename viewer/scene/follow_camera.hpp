// Where the camera wants to be: behind the probe while scanning, over the whole model when the scan is done. It moves
// smoothly, never faster than an eye likes, and not at all for the tremor of a hand.
#pragma once

#include <optional>

#include "pipeline/types/model_snapshot.hpp"
#include "pipeline/types/preview.hpp"
#include "viewer/scene/probe_field.hpp"
#include "viewer/scene/view_camera.hpp"

namespace enamel::view {

struct FollowConfig {
  double tilt_rad = 0.65;     ///< the view leans this far off the probe's axis, so that its field is seen as a volume
  double turn_rad = 0.28;     ///< and this far sideways
  double height_mm = 46;      ///< of the scene at the target
  double shift_right = 0.10;  ///< of that height: the target stands right of the middle, clear of the live image
  double start_mm = 2.5;      ///< hysteresis: a rest ends when the target is farther off than this …
  double stop_mm = 0.4;       ///< … and begins again below this
  double start_rad = 0.14;
  double stop_rad = 0.02;
  double time_constant_s = 0.45;
  double max_turn_rad_per_s = 0.52;  ///< 30 degrees a second
};

/// Camera for a probe at this pose. Without a surface distance the middle of the field is looked at.
[[nodiscard]] ViewCamera follow_goal(const Pose& T_model_cam, double surface_distance_mm, const ProbeField& field,
                                     const FollowConfig& config);

class FollowCamera {
 public:
  explicit FollowCamera(const FollowConfig& config = {}) : config_(config) {}

  /// One step of `dt_s` (>= 0) from `now` towards `goal`. The first call after reset() jumps.
  [[nodiscard]] ViewCamera step(const ViewCamera& now, const ViewCamera& goal, double dt_s);
  void reset() noexcept { jump_ = true; }
  [[nodiscard]] bool fresh() const noexcept { return jump_; }  ///< has no place yet
  [[nodiscard]] bool moving() const noexcept { return moving_; }

 private:
  FollowConfig config_;
  bool jump_ = true;
  bool moving_ = false;
};

/// Camera that shows all of the model from the side that it was scanned from, long side level. `fill` (0…1) is the
/// share of the picture to use. Empty when the model has no vertex.
[[nodiscard]] std::optional<ViewCamera> overview(const ModelSnapshot& model, double aspect, double fill = 0.82);

}  // namespace enamel::view
