#include "pipeline/register/icp/normal_system.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace enamel::pipeline {

Pose apply_motion(const Vector6& x, const Vec3d& centre, double rho_mm, const Pose& T) {
  const Vec3d omega = x.head<3>() / rho_mm;
  const double angle = omega.norm();
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (angle > 0) R = Eigen::AngleAxisd(angle, omega / angle).toRotationMatrix();
  Pose out = Pose::Identity();
  out.linear() = Eigen::Quaterniond(R * T.linear()).normalized().toRotationMatrix();
  out.translation() = R * (T.translation() - centre) + centre + x.tail<3>();
  return out;
}

Vector6 motion_between(const Pose& from, const Pose& to, const Vec3d& centre, double rho_mm) {
  const Eigen::Matrix3d R = to.linear() * from.linear().transpose();
  const Eigen::AngleAxisd turn(R);
  Vector6 x;
  x.head<3>() = turn.axis() * turn.angle() * rho_mm;
  x.tail<3>() = to.translation() - (R * (from.translation() - centre) + centre);
  return x;
}

Solution solve(const NormalSystem& system, const Vector6& x_prior, const PriorConfig& config) {
  Solution out;
  Matrix6 H = system.H / system.weight;
  Vector6 rhs = -system.g / system.weight;
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(H);
  out.eigenvalues = eigen.eigenvalues();
  for (int i = 0; i < 6; ++i) {
    if (out.eigenvalues[i] >= config.weak_eigenvalue) continue;
    ++out.weak;
    const double slack = 1 - std::max(0.0, out.eigenvalues[i]) / config.weak_eigenvalue;
    const double mu = config.stiffness * slack * slack;
    const Vector6 v = eigen.eigenvectors().col(i);
    H += mu * v * v.transpose();
    rhs += mu * v.dot(x_prior) * v;
  }
  out.x = H.ldlt().solve(rhs);
  return out;
}

}  // namespace enamel::pipeline
