// What the probe saw: for every vertex of the truth, in how many bursts it could have been measured.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/twin/render/burst_renderer.hpp"

namespace enamel::twin {

/// A vertex counts in a burst when it lies inside the camera image and the projector frame and within the depth range,
/// at no more than 70 degrees to camera and projector, and the truth maps show it there, visible and lit.
class SeenCounter {
 public:
  /// Keeps references. Depth range from the rig (40…56 mm when the rig states none).
  SeenCounter(const Instrument& instrument, const TriSurface& truth);
  void add(const Pose& T_model_cam, const TruthMaps& maps);
  /// One a vertex, stops at 255.
  [[nodiscard]] const std::vector<std::uint8_t>& counts() const { return counts_; }

 private:
  struct Cluster {
    Vec3d centre;
    double radius;
    std::vector<std::uint32_t> vertices;
  };
  [[nodiscard]] bool sees(const Pose& T_cam_model, const Vec3d& projector_model, const TruthMaps& maps,
                          std::uint32_t vertex) const;

  const Instrument& instrument_;
  const TriSurface& truth_;
  double near_mm_, far_mm_;
  std::vector<Cluster> clusters_;  ///< neighbours in space, so that most are skipped at once
  std::vector<std::uint8_t> counts_;
};

}  // namespace enamel::twin
