// The mount's lines from a scan's own poses, without a target: what the calibration says is the start and the prior,
// where the edges put the stops is the measurement. Alternated with the graph, which takes its priors from the lines.
#pragma once

#include <vector>

#include "calib/model/mount.hpp"
#include "pipeline/register/stops/mount_prior.hpp"
#include "pipeline/types/geometry.hpp"

namespace enamel::pipeline {

/// How far the lines may be from what the calibration says, one sigma.
struct MountSigma {
  double direction_rad = 5.236e-5;  ///< the most a calibration may leave open: 0.003 degrees …
  double place_mm = 0.003;          ///< … and 3 um
  double harmonic_rad = 3.5e-5;     ///< of either factor, 0.002 degrees
};

struct StopPose {
  calib::AxisAngles angles;
  Pose T_model_cam = Pose::Identity();
  Vec3d centre = Vec3d::Zero();  ///< of what it sees, model frame
};

/// Least squares over lines, harmonics and the model's place on the table, which the poses leave free. Stops that the
/// priors contradict count less and less. Deterministic. Fewer than three stops: the mount as given.
[[nodiscard]] calib::Mount refit_mount(const calib::Mount& start, const std::vector<StopPose>& stops,
                                       const MountSigma& lines, const StopSigma& stop, double rho_mm);

}  // namespace enamel::pipeline
