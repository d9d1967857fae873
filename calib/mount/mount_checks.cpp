#include "calib/mount/mount_checks.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace enamel::calib {
namespace {

constexpr double kSameStop_deg = 0.5;
constexpr double kSlipPriors = 2, kSlipSigmas = 6;

struct Reach {
  const char* name;
  std::size_t least;
  double span_deg;
};
constexpr Reach kReaches[2] = {{"table", 12, 180}, {"cradle", 5, 20}};

double angle_of(const AxisAngles& angles, int axis) { return axis == 0 ? angles.rotation() : angles.swing(); }

/// Degrees beyond the read angle: the stop's correction and the harmonic.
double beyond_deg(const Adjusted& a, std::size_t stop, int axis, double read_rad) {
  const AxisLine& line = axis == 0 ? a.state.rotation : a.state.swing;
  return kDegreesPerRad * (true_angle(read_rad, a.state.stops[stop][static_cast<std::size_t>(axis)],
                                      line.harmonic_rad[0], line.harmonic_rad[1]) -
                           read_rad);
}

}  // namespace

Result<void> check_stops(const std::vector<MountStop>& stops) {
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> degrees;
    for (const MountStop& stop : stops) degrees.push_back(angle_of(stop.angles, axis) * kDegreesPerRad);
    std::sort(degrees.begin(), degrees.end());
    std::size_t distinct = degrees.empty() ? 0 : 1;
    double last = degrees.empty() ? 0 : degrees.front();
    for (const double angle : degrees) {
      if (angle - last <= kSameStop_deg) continue;
      ++distinct;
      last = angle;
    }
    const Reach& reach = kReaches[axis];
    const double span = degrees.empty() ? 0 : degrees.back() - degrees.front();
    if (distinct < reach.least || span < reach.span_deg) {
      return fail(
          ErrorCode::kCalibrationPoses,
          fmt::format("the usable stops have {} angles of the {} over {:.0f} degrees; take at least {} over {:.0f}",
                      distinct, reach.name, span, reach.least, reach.span_deg));
    }
  }
  return {};
}

Result<void> check_slip(const std::vector<MountStop>& stops, const Adjusted& adjusted, const MountOptions& options) {
  const auto n = static_cast<Eigen::Index>(stops.size());
  for (int axis = 0; axis < 2; ++axis) {
    Eigen::MatrixXd columns(n, 4);
    Eigen::VectorXd beyond(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double read = angle_of(stops[static_cast<std::size_t>(j)].angles, axis);
      columns.row(j) << 1, std::cos(read), std::sin(read), static_cast<double>(j);
      beyond[j] = beyond_deg(adjusted, static_cast<std::size_t>(j), axis, read);
    }
    // A cradle that swings little has cosines next to constant: the pseudo-inverse takes what there is.
    const Eigen::MatrixXd normal = columns.transpose() * columns;
    const Eigen::MatrixXd inverse = normal.completeOrthogonalDecomposition().pseudoInverse();
    const Eigen::VectorXd x = inverse * (columns.transpose() * beyond);
    const double scatter2 =
        (beyond - columns * x).squaredNorm() / static_cast<double>(std::max<Eigen::Index>(1, n - 4));
    const double sigma = std::sqrt(std::max(scatter2 * inverse(3, 3), 1e-24));
    const double drift = std::abs(x[3]) * static_cast<double>(n - 1);
    if (drift < kSlipPriors * options.stop_prior_rad * kDegreesPerRad || std::abs(x[3]) < kSlipSigmas * sigma) continue;
    return fail(
        ErrorCode::kCalibrationRefused,
        fmt::format("the {} slips: its angle runs away from the one read or commanded by {:.4f} degrees a stop, "
                    "{:.2f} over the set; check the drive's grip and its steps a turn, then take the set again",
                    kReaches[axis].name, x[3], drift));
  }
  return {};
}

std::optional<WrongStop> worst_stop(const Adjusted& adjusted, const MountOptions& options) {
  std::optional<WrongStop> worst;
  double largest = options.gross * options.stop_prior_rad;
  for (std::size_t j = 0; j < adjusted.state.stops.size(); ++j) {
    for (int axis = 0; axis < 2; ++axis) {
      const double correction = adjusted.state.stops[j][static_cast<std::size_t>(axis)];
      if (!(std::abs(correction) > largest)) continue;
      largest = std::abs(correction);
      worst =
          WrongStop{j, fmt::format("the {} stands {:.3f} degrees from where its angle says, {:.0f} times the stops' "
                                   "sigma: a wrong angle, a lost step, or the board was moved",
                                   kReaches[axis].name, correction * kDegreesPerRad,
                                   std::abs(correction) / options.stop_prior_rad)};
    }
  }
  return worst;
}

}  // namespace enamel::calib
