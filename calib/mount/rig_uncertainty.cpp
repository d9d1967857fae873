#include "calib/mount/rig_uncertainty.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "calib/io/rig_details.hpp"
#include "calib/solve/bundle.hpp"

namespace enamel::calib {
namespace {

constexpr double kRounding = 1e-9;  // of the largest: written decimals and the solver's own

}  // namespace

Eigen::MatrixXd rig_covariance_of(const Rig& rig) {
  const RigDetails details = read_rig_details(rig);
  const auto names = rig_parameter_names();
  if (!std::equal(names.begin(), names.end(), details.parameter_names.begin(), details.parameter_names.end()))
    return {};
  const Eigen::MatrixXd& c = details.covariance;
  if (!c.allFinite() || c.diagonal().minCoeff() < 0) return {};
  // Pixels beside radians: only what each is of its own sigma can be compared.
  const Eigen::VectorXd scale = c.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * (0.5 * (c + c.transpose())) * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
  if (solver.eigenvalues()[0] < -kRounding * solver.eigenvalues().tail<1>()[0]) return {};
  return 0.5 * (c + c.transpose());
}

}  // namespace enamel::calib
