#include "calib/solve/disc_bias.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

#include "calib/model/lens.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kOutline = 48;  // trapezoid rule on a smooth closed curve: converges faster than any power
constexpr int kSteps = 4;

Vector2d image_of(const LensValues& lens, const Vec3d& p) {
  const PlanePoint q = project(lens, {p.x() / p.z(), p.y() / p.z()});
  return {q.x, q.y};
}

}  // namespace

Vector2d disc_bias(const LensValues& lens, const Pose& T_cam_target, const Vec3d& centre_mm, double radius_mm) {
  const Vector2d centre = image_of(lens, T_cam_target * centre_mm);
  std::array<Vector2d, kOutline> outline;
  for (std::size_t k = 0; k < kOutline; ++k) {
    const double a = 2 * std::numbers::pi * static_cast<double>(k) / kOutline;
    const Vec3d p = centre_mm + radius_mm * Vec3d(std::cos(a), std::sin(a), 0);
    outline[k] = image_of(lens, T_cam_target * p) - centre;
  }
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (const auto& p : outline) second += p * p.transpose() / kOutline;
  const Eigen::Matrix2d start = second.inverse() / 2;  // an ellipse's outline has half its squared half axes
  Vector5d x;
  x << 0, 0, start(0, 0), start(0, 1), start(1, 1);
  for (int step = 0; step < kSteps; ++step) {
    Matrix5d h = Matrix5d::Zero();
    Vector5d b = Vector5d::Zero();
    for (std::size_t k = 0; k < kOutline; ++k) {
      const Vector2d q = outline[k] - x.head<2>();
      const Vector2d mq(x[2] * q.x() + x[3] * q.y(), x[3] * q.x() + x[4] * q.y());
      const double f = std::sqrt(q.dot(mq)), n = mq.norm();
      const double length = (outline[(k + 1) % kOutline] - outline[(k + kOutline - 1) % kOutline]).norm();
      const double inside = (1 - f) * f / n;
      Vector5d j;
      j << mq / n, -q.x() * q.x() / (2 * n), -q.x() * q.y() / n, -q.y() * q.y() / (2 * n);
      h += length * j * j.transpose();
      b -= length * inside * j;
    }
    x += h.ldlt().solve(b);
  }
  return x.head<2>();
}

}  // namespace enamel::calib
