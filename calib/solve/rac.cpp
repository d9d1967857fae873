// Tsai's radial alignment constraint for coplanar points (1987; docs/calibration.md §4). Image coordinates here are
// pixels from the principal point: x = u - cx, y = v - cy.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/solve/lens_start.hpp"
#include "calib/solve/refine_lens.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kSingularSine = 0.12;  // sine of the tilt, 7 degrees: focal length over distance is all that shows

struct PoseStart {
  Pose pose = Pose::Identity();  // without distance for singular poses
  double focal_px = 0;
  double information = 0;  // of the focal length; 0 = singular
};

struct Centred {
  std::vector<Vector2d> target, image;  // target relative to `origin`
  Vector2d origin{0, 0};
};

/// Tsai divides by Ty: the target's origin is moved to the point farthest from the image's x axis.
Centred centred(const PlaneView& view, const LensValues& lens) {
  Centred out;
  for (const auto& p : view.image_px) out.image.push_back(p - Vector2d(lens.cx, lens.cy));
  const auto far = std::max_element(out.image.begin(), out.image.end(), [](const Vector2d& p, const Vector2d& q) {
    return std::abs(p.y()) < std::abs(q.y());
  });
  out.origin = view.target_mm[static_cast<std::size_t>(far - out.image.begin())];
  for (const auto& p : view.target_mm) out.target.emplace_back(p - out.origin);
  return out;
}

/// First two rows of the rotation (their first two columns) and Tx, Ty, from the radial alignment alone.
struct Lateral {
  double r1, r2, r4, r5, tx, ty;
};

Result<Lateral> solve_lateral(const Centred& view, const std::string& name) {
  Eigen::MatrixXd a(static_cast<Eigen::Index>(view.target.size()), 5);
  Eigen::VectorXd b(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const Vector2d& t = view.target[static_cast<std::size_t>(i)];
    const Vector2d& p = view.image[static_cast<std::size_t>(i)];
    a.row(i) << p.y() * t.x(), p.y() * t.y(), p.y(), -p.x() * t.x(), -p.x() * t.y();
    b[i] = p.x();
  }
  const Eigen::VectorXd s = a.colPivHouseholderQr().solve(b);  // r1 r2 Tx r4 r5, all over Ty
  const double sum = s[0] * s[0] + s[1] * s[1] + s[3] * s[3] + s[4] * s[4];
  const double d = s[0] * s[4] - s[3] * s[1];
  if (!(std::abs(d) > 1e-12 * sum) || !s.allFinite())
    return fail(ErrorCode::kCalibrationPoses, "RAC: pose " + name + " is seen edge on");
  const double ty2 = (sum - std::sqrt(std::max(0.0, sum * sum - 4 * d * d))) / (2 * d * d);
  Lateral l{s[0], s[1], s[3], s[4], s[2], 1};
  double ty = std::sqrt(ty2);
  // The origin has image y of the sign of Ty (its distance is positive).
  const auto origin = std::min_element(view.target.begin(), view.target.end(),
                                       [](const Vector2d& p, const Vector2d& q) { return p.norm() < q.norm(); });
  if (view.image[static_cast<std::size_t>(origin - view.target.begin())].y() < 0) ty = -ty;
  for (double* value : {&l.r1, &l.r2, &l.r4, &l.r5, &l.tx, &l.ty}) *value *= ty;
  return l;
}

/// The whole rotation; `sign` chooses which way the target leans.
Eigen::Matrix3d rotation(const Lateral& l, double sign) {
  const double r3 = sign * std::sqrt(std::max(0.0, 1 - l.r1 * l.r1 - l.r2 * l.r2));
  double r6 = std::sqrt(std::max(0.0, 1 - l.r4 * l.r4 - l.r5 * l.r5));
  if ((l.r1 * l.r4 + l.r2 * l.r5) * r3 > 0) r6 = -r6;
  const Eigen::Vector3d x = Eigen::Vector3d(l.r1, l.r2, r3).normalized();
  Eigen::Vector3d y = Eigen::Vector3d(l.r4, l.r5, r6);
  y = (y - x.dot(y) * x).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), y.transpose(), x.cross(y).transpose();
  return r;
}

/// Focal length and Tz of one pose: y (r7 X + r8 Y + Tz) = f (r4 X + r5 Y + Ty), and the same for x.
Eigen::Vector2d focal_and_distance(const Centred& view, const Eigen::Matrix3d& r, const Lateral& l, double& info) {
  Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
  Eigen::Vector2d b(0, 0);
  for (std::size_t i = 0; i < view.target.size(); ++i) {
    const Vector2d& t = view.target[i];
    const Vector2d& p = view.image[i];
    const double depth = r(2, 0) * t.x() + r(2, 1) * t.y();
    const Vector2d lateral(r(0, 0) * t.x() + r(0, 1) * t.y() + l.tx, r(1, 0) * t.x() + r(1, 1) * t.y() + l.ty);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d j(lateral[k], -p[k]);
      h += j * j.transpose();
      b += j * depth * p[k];
    }
  }
  info = h(0, 0) - h(0, 1) * h(0, 1) / h(1, 1);
  return h.ldlt().solve(b);
}

Result<PoseStart> pose_start(const PlaneView& view, const LensValues& lens) {
  const Centred c = centred(view, lens);
  ENAMEL_TRY_ASSIGN(const Lateral l, solve_lateral(c, view.name));
  PoseStart out;
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Matrix3d r = rotation(l, sign);
    double info = 0;
    const Eigen::Vector2d x = focal_and_distance(c, r, l, info);
    if (!(x[0] > 0 && x[1] > 0)) continue;
    out.pose.linear() = r;
    out.focal_px = x[0];
    out.information = std::hypot(r(2, 0), r(2, 1)) > kSingularSine ? info : 0;
    out.pose.translation() = Vec3d(l.tx, l.ty, x[1]) - r.leftCols<2>() * c.origin;
    return out;
  }
  return out;
}

}  // namespace

Result<LensStart> rac_start(const std::vector<PlaneView>& views, const LensValues& design) {
  LensStart start{.method = "RAC", .lens = design, .T_lens_target = {}, .rms_px = 0, .singular_poses = {}};
  start.lens.dist = {0, 0, 0, 0, design.dist[4]};
  std::vector<std::pair<double, double>> focal;  // value, weight
  double total = 0;
  for (const PlaneView& view : views) {
    ENAMEL_TRY_ASSIGN(const PoseStart pose, pose_start(view, start.lens));
    if (!(pose.information > 0)) {
      start.singular_poses.push_back(view.name);
      continue;
    }
    focal.emplace_back(pose.focal_px, pose.information);
    total += pose.information;
  }
  if (focal.empty()) return fail(ErrorCode::kCalibrationPoses, "RAC: every pose is parallel to the image plane");
  std::sort(focal.begin(), focal.end());
  double below = 0;
  for (const auto& [value, weight] : focal) {  // weighted median: one bad pose does not move it
    start.lens.fx = start.lens.fy = value;
    below += weight;
    if (below >= 0.5 * total) break;
  }
  ENAMEL_TRY_ASSIGN(start.T_lens_target, poses_for_lens(views, start.lens));
  refine_stepwise(views, start);
  return start;
}

}  // namespace enamel::calib
