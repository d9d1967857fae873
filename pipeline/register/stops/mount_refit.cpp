#include "pipeline/register/stops/mount_refit.hpp"

#include <Eigen/Cholesky>
#include <array>

#include "pipeline/register/map/graph_terms.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kLine = 6;  // two tilts, two shifts, two factors of the harmonic
constexpr int kLines = 2 * kLine;
constexpr int kUnknowns = kLines + 6;  // … and the model's frame beside the mount's
constexpr std::size_t kFewestStops = 3;
constexpr int kRounds = 6;
constexpr double kSwitchSigmas = 4;  // as GraphConfig
constexpr double kStep = 1e-6;       // of the differences, rad and mm: errors of 1e-9 of what they are of

using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

struct LineBase {
  Vec3d direction, point, e1, e2;
};

LineBase base_of(const calib::AxisLine& line, const Vec3d& near) {
  const Vec3d d(line.direction.data()), p(line.point_mm.data());
  const Vec3d e1 = d.unitOrthogonal();
  return {d, p + d * d.dot(near - p), e1, d.cross(e1)};
}

calib::AxisLine moved(const calib::AxisLine& line, const LineBase& base, const Eigen::Matrix<double, kLine, 1>& by) {
  calib::AxisLine out = line;
  const Vec3d d = (base.direction + by[0] * base.e1 + by[1] * base.e2).normalized();
  const Vec3d p = base.point + by[2] * base.e1 + by[3] * base.e2;
  out.direction = {d.x(), d.y(), d.z()};
  out.point_mm = {p.x(), p.y(), p.z()};
  out.harmonic_rad = {line.harmonic_rad[0] + by[4], line.harmonic_rad[1] + by[5]};
  return out;
}

class Refit {
 public:
  Refit(const calib::Mount& start, const std::vector<StopPose>& stops, const StopSigma& sigma, double rho_mm)
      : start_(start), stops_(stops), rho_mm_(rho_mm) {
    for (const StopPose& stop : stops) middle_ += stop.centre / static_cast<double>(stops.size());
    rotation_ = base_of(start.rotation, middle_);
    swing_ = base_of(start.swing, middle_);
    for (const StopPose& stop : stops) {
      const Matrix6 C = pose_covariance(axis_motions(start, stop.angles, stop.centre, rho_mm), sigma, rho_mm);
      whiten_.push_back(C.llt().matrixL().solve(Matrix6::Identity()));
    }
  }

  [[nodiscard]] calib::Mount mount(const Unknowns& x) const {
    calib::Mount out = start_;
    out.rotation = moved(start_.rotation, rotation_, x.head<kLine>());
    out.swing = moved(start_.swing, swing_, x.segment<kLine>(kLine));
    return out;
  }

  /// A whitened residual a stop.
  [[nodiscard]] std::vector<Vector6> residuals(const Unknowns& x) const {
    const calib::Mount m = mount(x);
    std::vector<Vector6> out;
    out.reserve(stops_.size());
    for (std::size_t k = 0; k < stops_.size(); ++k) {
      const StopPose& stop = stops_[k];
      const Pose told = apply_motion(x.tail<6>(), middle_, rho_mm_, pose_by_axes(m, stop.angles));
      out.push_back(whiten_[k] * motion_between(told, stop.T_model_cam, stop.centre, rho_mm_));
    }
    return out;
  }

  /// One step of Gauss-Newton from x, held by `prior`, the inverse variances of the lines.
  [[nodiscard]] Unknowns step(const Unknowns& x, const Unknowns& prior) const {
    const std::vector<Vector6> at = residuals(x);
    std::array<std::vector<Vector6>, kUnknowns> beside;
    for (int k = 0; k < kUnknowns; ++k) {
      Unknowns further = x;
      further[k] += kStep;
      beside[static_cast<std::size_t>(k)] = residuals(further);
    }
    Eigen::Matrix<double, kUnknowns, kUnknowns> H = prior.asDiagonal();
    Unknowns g = prior.cwiseProduct(x);
    for (std::size_t n = 0; n < at.size(); ++n) {
      Eigen::Matrix<double, 6, kUnknowns> J;
      for (int k = 0; k < kUnknowns; ++k) J.col(k) = (beside[static_cast<std::size_t>(k)][n] - at[n]) / kStep;
      const double trust = switch_of(at[n].squaredNorm() / 6, kSwitchSigmas);
      H += trust * J.transpose() * J;
      g += trust * J.transpose() * at[n];
    }
    return x - H.ldlt().solve(g);
  }

 private:
  const calib::Mount& start_;
  const std::vector<StopPose>& stops_;
  double rho_mm_;
  Vec3d middle_ = Vec3d::Zero();
  LineBase rotation_, swing_;
  std::vector<Matrix6> whiten_;
};

}  // namespace

calib::Mount refit_mount(const calib::Mount& start, const std::vector<StopPose>& stops, const MountSigma& lines,
                         const StopSigma& stop, double rho_mm) {
  if (stops.size() < kFewestStops) return start;
  const auto weight = [](double sigma) { return 1 / (sigma * sigma); };
  Unknowns prior = Unknowns::Constant(1e-9);  // the frame is free; so little keeps what nothing determines in place
  for (const int line : {0, kLine}) {
    prior.segment<2>(line).setConstant(weight(lines.direction_rad));
    prior.segment<2>(line + 2).setConstant(weight(lines.place_mm));
    prior.segment<2>(line + 4).setConstant(weight(lines.harmonic_rad));
  }
  const Refit refit(start, stops, stop, rho_mm);
  Unknowns x = Unknowns::Zero();
  for (int round = 0; round < kRounds; ++round) x = refit.step(x, prior);
  return refit.mount(x);
}

}  // namespace enamel::pipeline
