#include "calib/judge/plane_check.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/judge/plane_fit.hpp"
#include "calib/solve/ground.hpp"
#include "calib/solve/triangulate.hpp"

namespace enamel::calib {
namespace {

constexpr std::size_t kMinPoints = 100;
constexpr double kHalfPlane_mm = 8;
constexpr double kGrossSigmas = 5;
constexpr double kStart_mm = 48;        // of the search for a depth
constexpr double kSlopePrior_um = 0.5;  // sigma of what bow and twist change from the near to the far end

struct GroundPoint {
  Eigen::Vector2d camera_px{0, 0};
  Vec3d place;
  double height_mm = 0;  ///< of the board there
  double noise_mm = 0;   ///< sigma along z that the pixels' noise explains
};

std::vector<GroundPoint> ground_points(const std::vector<GroundSample>& ground, const TargetDesign& target,
                                       const RigState& rig) {
  std::vector<GroundPoint> points;
  points.reserve(ground.size());
  for (const GroundSample& s : ground) {
    const Vec3d ray = camera_ray(rig.camera, s.camera_px.x(), s.camera_px.y());
    const Vec3d p = triangulate(rig, ray, s.projector_u_px, kStart_mm);
    const double sigma_px = std::sqrt(s.variance_px2);
    const Vec3d moved = triangulate(rig, ray, s.projector_u_px + sigma_px, p.z());
    points.push_back({s.camera_px, p, board_height_mm(target, s.cell, rig.dot_offsets_mm), (moved - p).norm()});
  }
  return points;
}

struct Flat {
  Vec3d middle;
  Eigen::Matrix3d axes;  // columns: in the plane along camera x, across, normal away from the camera
};

Flat best_plane(const std::vector<GroundPoint>& points) {
  const auto [middle, normal] = plane_through(points);
  const Vec3d x = (Vec3d::UnitX() - normal.x() * normal).normalized();
  Flat flat{middle, {}};
  flat.axes << x, normal.cross(x), normal;
  return flat;
}

/// The points of a board as if it were flat: its own height taken off along the plane's normal; the noise becomes that
/// along the normal.
void flatten(std::vector<GroundPoint>& points) {
  const Vec3d normal = best_plane(points).axes.col(2);
  for (GroundPoint& p : points) {
    p.noise_mm *= std::abs(normal.dot(p.place.normalized()));
    p.place += p.height_mm * normal;
  }
}

/// Drops points far off the plane of the rest: specks and shadow borders.
void drop_gross(std::vector<GroundPoint>& points) {
  const Flat flat = best_plane(points);
  const auto height = [&](const GroundPoint& p) { return std::abs(flat.axes.col(2).dot(p.place - flat.middle)); };
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const GroundPoint& p : points) heights.push_back(height(p));
  std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
  const double limit = kGrossSigmas * heights[heights.size() / 2] / 0.6745;
  std::erase_if(points, [&](const GroundPoint& p) { return height(p) > limit; });
}

double p95_of(std::vector<PlaneHeight> heights) {
  const auto at = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() * 95 / 100);
  std::nth_element(heights.begin(), at, heights.end(), [](const PlaneHeight& a, const PlaneHeight& b) {
    return std::abs(a.height_um) < std::abs(b.height_um);
  });
  return std::abs(at->height_um);
}

/// Heights over the best plane, and the quadratic through them.
PlaneCheck measure_flat(const std::vector<GroundPoint>& points) {
  PlaneCheck out{.pose = {}, .points = points.size(), .shape = {}, .sigma = {}, .heights = {}};
  const Flat flat = best_plane(points);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double squares = 0, noise = 0;
  for (const GroundPoint& p : points) {
    const Vec3d q = flat.axes.transpose() * (p.place - flat.middle);
    const double x = q.x() / kHalfPlane_mm, y = q.y() / kHalfPlane_mm, z = 1e3 * q.z();
    const Eigen::Matrix<double, 6, 1> j = (Eigen::Matrix<double, 6, 1>() << 1, x, y, x * x, x * y, y * y).finished();
    h += j * j.transpose();
    b += j * z;
    squares += z * z;
    noise += 1e6 * p.noise_mm * p.noise_mm;
    out.heights.push_back({p.camera_px, z});
  }
  const double n = static_cast<double>(points.size());
  const Eigen::Matrix<double, 6, 6> inverse = h.inverse();
  const Eigen::Matrix<double, 6, 1> fit = inverse * b;
  const double left = (squares - fit.dot(b)) / (n - 6);
  const auto sigma = [&](Eigen::Index i) { return std::sqrt(std::max(0.0, left * inverse(i, i))); };
  out.depth_mm = flat.middle.z();
  out.rms_um = std::sqrt(squares / n);
  out.noise_um = std::sqrt(noise / n);
  out.p95_um = p95_of(out.heights);
  out.shape = {fit[3], fit[5], fit[4]};
  out.sigma = {sigma(3), sigma(5), sigma(4)};
  return out;
}

}  // namespace

Result<PlaneCheck> check_plane(const PoseView& view, const TargetDesign& target, const RigState& rig,
                               const Ripple& ripple) {
  std::vector<GroundSample> ground = view.ground;
  remove_ripple(ripple, ground);
  std::vector<GroundPoint> points = ground_points(ground, target, rig);
  if (points.size() >= kMinPoints) {
    flatten(points);
    drop_gross(points);
  }
  if (points.size() < kMinPoints) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("pose {}: {} usable places on the ground between the dots", view.name, points.size()));
  }
  PlaneCheck check = measure_flat(points);
  check.pose = view.name;
  return check;
}

std::array<DepthShape, 3> shapes_over_depth(const std::vector<PlaneCheck>& planes, DepthRange range) {
  std::array<DepthShape, 3> out;
  const double middle_mm = 0.5 * (range.near_mm + range.far_mm), deep = range.far_mm - range.near_mm;
  const auto line = [&](double PlaneShape::*part) {
    Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b(0, 0);
    for (const PlaneCheck& p : planes) {
      const double weight = 1 / std::max(1e-12, std::pow(p.sigma.*part, 2));
      const Eigen::Vector2d j(1, (p.depth_mm - middle_mm) / deep);
      h += weight * j * j.transpose();
      b += weight * j * (p.shape.*part);
    }
    h(1, 1) += 1 / (kSlopePrior_um * kSlopePrior_um);  // planes at one depth say nothing about another
    for (std::size_t k = 0; k < out.size(); ++k) {
      const Eigen::Vector2d j(1, (1 + 3 * static_cast<double>(k)) / 8 - 0.5);
      out[k].depth_mm = range.near_mm + deep * (1 + 3 * static_cast<double>(k)) / 8;
      out[k].shape.*part = planes.empty() ? 0 : j.dot(h.ldlt().solve(b));
      out[k].sigma.*part = planes.empty() ? 0 : std::sqrt(j.dot(h.ldlt().solve(j)));
    }
  };
  line(&PlaneShape::sag_x_um);
  line(&PlaneShape::sag_y_um);
  line(&PlaneShape::twist_um);
  return out;
}

}  // namespace enamel::calib
