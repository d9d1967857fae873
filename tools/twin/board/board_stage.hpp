// A board before the probe on a stage: its stands, and what the camera gets of every pattern at each.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/twin/optics/multi_patterns.hpp"
#include "tools/twin/render/still_renderer.hpp"
#include "tools/twin/scene/scene.hpp"

namespace enamel::twin {

class BoardStage {
 public:
  /// The board of `scene`, whatever its own object is, before its rig, at stands drawn by the seed or, on a mount's
  /// path, at the mount's stops. Errors: those of the rig;
  /// kRigInvalid when the rig carries no noise; kConfigValue when the board does not fit.
  [[nodiscard]] static Result<std::unique_ptr<BoardStage>> create(const SceneConfig& scene);

  [[nodiscard]] const calib::Rig& rig() const { return instrument_.rig; }  ///< the truth
  [[nodiscard]] const SensorConfig& sensor() const { return sensor_; }
  [[nodiscard]] const MultiPatterns& patterns() const { return patterns_; }
  [[nodiscard]] const std::vector<Pose>& stands() const { return stands_; }  ///< T_model_cam

  [[nodiscard]] StillView trace(std::size_t stand) const { return renderer_.trace(stands_[stand]); }
  /// Mean electrons of the four frames of a pattern set, the camera's point spread included.
  [[nodiscard]] std::array<std::vector<float>, 4> electrons(const StillView& view, int set) const;

 private:
  BoardStage(const SceneConfig& scene, const calib::Rig& rig);

  Instrument instrument_;
  RayScene scene_;
  StillRenderer renderer_;
  SensorConfig sensor_;
  MultiPatterns patterns_;
  std::vector<ProjectorLight> lights_;  ///< one a pattern set
  std::vector<Pose> stands_;
};

}  // namespace enamel::twin
