// Steps 2 and 3: camera, projector, their relative pose, all target poses and, when asked, the target's own shape and
// the planes of its ground in one least-squares problem.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "calib/solve/observation.hpp"

namespace enamel::calib {

/// Real targets differ from their drawing: dots are off by some microns, boards bow. Priors keep the shape from taking
/// over the poses' and the scale's part: offsets are normal with these sigmas, mm.
struct ShapePrior {
  double in_plane_mm = 0.005;
  double out_of_plane_mm = 0.05;
};

/// What the residuals say about the stated variances (variance component estimation). The camera's become
/// camera * stated + camera_floor_px2: what a renderer's or a sensor's pixels add does not shrink with a disc's own
/// noise.
struct VarianceFactors {
  double camera = 1, camera_floor_px2 = 0, projector = 1;
  double ground = 1;  ///< of the samples between the dots
};

struct BundleOptions {
  bool solve_shape = false;
  ShapePrior shape;
  VarianceFactors variance;
  bool with_covariance = false;
  /// Step 3: the distances of the ground's points from their planes join the dots, which hold the metric: planes alone
  /// stay planes under every projective map.
  bool with_planes = false;
};

/// The rig's parameters in this order: camera fx fy cx cy k1 k2 p1 p2, projector the same, T_proj_cam's rotation vector
/// and translation. k3 of both stays as it is.
inline constexpr int kRigParameters = 22;
[[nodiscard]] std::array<const char*, kRigParameters> rig_parameter_names();

/// Whitened residuals of one dot in one pose.
struct DotResidual {
  std::size_t pose = 0, view = 0;
  Eigen::Vector2d camera_px{0, 0}, projector_px{0, 0};  ///< measured less predicted; the projector's at the measured
                                                        ///< centre, as a reprojection error is understood
  double camera_chi2 = 0, projector_chi2 = 0;           ///< independent parts, two degrees of freedom each
};

struct BundleResult {
  std::vector<DotResidual> residuals;  ///< of all dots, outliers too
  double chi2 = 0;                     ///< of the dots that took part, without the prior
  int observations = 0;                ///< scalar ones that took part
  int parameters = 0;
  double rms_camera_px = 0, rms_projector_px = 0;  ///< sqrt(mean(dx² + dy²))
  Eigen::MatrixXd covariance;                      ///< kRigParameters square; empty unless asked or when singular
};

/// Improves `state`. Deterministic: one thread, fixed order.
/// The projector's residual is taken at the predicted camera place, so that it does not share the centre's error.
[[nodiscard]] BundleResult bundle(const std::vector<PoseView>& poses, const TargetDesign& target,
                                  const BundleOptions& options, RigState& state);

/// Squares of the whitened distances of the ground from its planes, all poses, means over the grid's cells; one degree
/// of freedom each.
[[nodiscard]] std::vector<double> plane_chi2(const std::vector<PoseView>& poses, const TargetDesign& target,
                                             const RigState& state, double variance_factor);

/// Residuals of a state as it stands.
[[nodiscard]] BundleResult evaluate(const std::vector<PoseView>& poses, const TargetDesign& target,
                                    const BundleOptions& options, const RigState& state);

}  // namespace enamel::calib
