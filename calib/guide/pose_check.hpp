// Is a pose of the target worth taking, and why not.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/io/calib_folder.hpp"
#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Where the target stands, by the nominal camera: good to some tenths of a millimetre and a degree.
struct SeenPose {
  double depth_mm = 0;                   ///< camera z of the target's middle
  double tilt_deg = 0;                   ///< of its normal against the line of sight
  double azimuth_deg = 0;                ///< to which side it leans in the image: 0 right, 90 down; -180 … 180
  double blur_px = 0;                    ///< sigma of the dots' edges
  double saturated = 0;                  ///< share of the white frame's pixels at full scale
  std::vector<Eigen::Vector2d> dots_px;  ///< camera, by rising index of those measured
};

struct PoseCheck {
  SeenPose seen;                     ///< as far as the target was found
  std::vector<std::string> reasons;  ///< why it is refused, each with what to do; empty: accepted
  [[nodiscard]] bool is_accepted() const { return reasons.empty(); }
};

class PoseChecker {
 public:
  /// noise: of one frame. `averaged`: frames in each picture.
  PoseChecker(TargetDesign target, Rig nominal, PixelNoise noise, int averaged, double saturation_dn)
      : target_(std::move(target)),
        nominal_(std::move(nominal)),
        noise_(noise.of_mean(averaged)),
        saturation_dn_(saturation_dn) {}

  /// `earlier`: poses accepted so far, so that none is taken twice. Deterministic. Not thread-safe: the first usable
  /// pose settles how the camera blurs.
  [[nodiscard]] PoseCheck check(const PoseFrames& frames, const std::vector<SeenPose>& earlier);

 private:
  [[nodiscard]] SeenPose stand(const PoseView& view) const;

  TargetDesign target_;
  Rig nominal_;
  PixelNoise noise_;
  double saturation_dn_;
  std::optional<EdgeModel> edges_;
};

}  // namespace enamel::calib
