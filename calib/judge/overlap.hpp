// Where two views of a scan see the same surface: how far apart they put it, and what a drift of the calibration or a
// motion of either view would change about that.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "calib/judge/drift_view.hpp"
#include "calib/model/rig.hpp"

namespace enamel::calib {

/// A drifted rig reads 1/z + delta for 1/z. delta = sum theta_m b_m(x, y), x and y those of the ray (x, y, 1):
/// b = 1, x, y, xy, x², y². The first three are projective maps, such as a shift of the projector makes, the others
/// bend a flat by the same height at every depth. A turn of the projector does both. x² and y² stand apart, not as
/// their sum and difference: what a scan says about them differs fourfold, and either mixture is as uncertain as the
/// worse one.
inline constexpr int kDriftModes = 6;
using DriftVector = Eigen::Matrix<double, kDriftModes, 1>;

[[nodiscard]] DriftVector drift_basis(const Vec3d& ray);

/// Normal equations of one pair of views, unknowns (omega, tau) of the first, of the second, theta. A view moves by
/// p -> p + omega x (p - c) + tau in its own camera frame about c = (0, 0, 48) mm.
inline constexpr int kPairUnknowns = 12 + kDriftModes;
struct PairSystem {
  Eigen::Matrix<double, kPairUnknowns, kPairUnknowns> H = Eigen::Matrix<double, kPairUnknowns, kPairUnknowns>::Zero();
  Eigen::Matrix<double, kPairUnknowns, 1> g = Eigen::Matrix<double, kPairUnknowns, 1>::Zero();
  std::size_t matches = 0;
  double weighted_squares = 0, weight = 0;  ///< of the residuals, without the kernel
};

inline constexpr double kDriftPivot_mm = 48;

struct OverlapConfig {
  int stride = 6;                ///< in cells: what counts is many views, not many points of each
  double max_distance_mm = 0.1;  ///< point to plane; Welsch kernel of a third of it
  double min_cosine = 0.85;      ///< between the two normals
};

/// Cells of `from` laid on the surface of `onto` (projective association), with theta already taken off both. Pure.
[[nodiscard]] PairSystem overlap(const DriftView& from, const DriftView& onto, const LensValues& camera,
                                 const DriftVector& theta, const OverlapConfig& config);

}  // namespace enamel::calib
