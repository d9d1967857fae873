#include "pipeline/register/track/mid_burst.hpp"

#include <Eigen/QR>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/icp/seconds.hpp"

namespace enamel::pipeline {
namespace {

constexpr Eigen::Index kMost = 5;  ///< two positions and three velocities

/// Conditions on the coefficients c1 … c5 of the motion x(s) = c1 s + c2 s^2 + … about one pose; s in units of `scale`.
class LocalMotion {
 public:
  explicit LocalMotion(double scale_s) : scale_(scale_s) {}

  void position(double s, const Vector6& x) {
    double power = s / scale_;
    for (Eigen::Index k = 0; k < kMost; ++k, power *= s / scale_) rows_(count_, k) = power;
    values_.row(count_++) = x.transpose();
  }

  void velocity(double s, const Vector6& x_per_s) {
    double power = 1;
    for (Eigen::Index k = 0; k < kMost; ++k, power *= s / scale_) rows_(count_, k) = static_cast<double>(k + 1) * power;
    values_.row(count_++) = scale_ * x_per_s.transpose();
  }

  /// c2 in 1/s^2 of the polynomial that meets all conditions, two at least.
  [[nodiscard]] Vector6 second() const {
    const Eigen::MatrixXd c = rows_.topLeftCorner(count_, count_).colPivHouseholderQr().solve(values_.topRows(count_));
    return c.row(1).transpose() / (scale_ * scale_);
  }

 private:
  double scale_;
  Eigen::Index count_ = 0;
  Eigen::Matrix<double, kMost, kMost> rows_;
  Eigen::Matrix<double, kMost, 6> values_;
};

/// A burst's velocity as turn and shift about `centre`, in the model's axes.
Vector6 velocity_about(const MeasuredPose& p, const Vec3d& centre) {
  const ProbeTwist& twist = *p.motion.twist;
  const Vec3d turn = p.T_model_cam.linear() * twist.turn_rad_s;
  const Vec3d at = p.T_model_cam * Vec3d(0, 0, twist.about_mm);
  Vector6 out;
  out << turn, p.T_model_cam.linear() * twist.shift_mm_s + turn.cross(centre - at);
  return out;
}

bool near(const MeasuredPose& before, const MeasuredPose& after, const MidBurstConfig& config) {
  const double gap = seconds(before.t_mid, after.t_mid);
  return gap > 0 && gap <= config.max_gap_s;
}

/// The middle one of three.
Pose carried_to_mid_burst(std::span<const MeasuredPose> three, const MidBurstConfig& config) {
  const MeasuredPose& here = three[1];
  const Vec3d centre = here.T_model_cam * Vec3d(0, 0, config.work_distance_mm);
  LocalMotion motion(config.max_gap_s);
  for (const MeasuredPose* p : {&three[0], &three[2]})
    motion.position(seconds(here.t_mid, p->t_mid), motion_between(here.T_model_cam, p->T_model_cam, centre, 1.0));
  for (const MeasuredPose& p : three)
    if (p.motion.twist) motion.velocity(seconds(here.t_mid, p.t_mid), velocity_about(p, centre));
  return apply_motion(-motion.second() * here.motion.exposure_spread_s2, centre, 1.0, here.T_model_cam);
}

}  // namespace

std::vector<Pose> poses_at_mid_burst(std::span<const MeasuredPose> poses, const MidBurstConfig& config) {
  std::vector<Pose> out;
  out.reserve(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const bool between =
        i > 0 && i + 1 < poses.size() && near(poses[i - 1], poses[i], config) && near(poses[i], poses[i + 1], config);
    out.push_back(between ? carried_to_mid_burst(poses.subspan(i - 1, 3), config) : poses[i].T_model_cam);
  }
  return out;
}

}  // namespace enamel::pipeline
