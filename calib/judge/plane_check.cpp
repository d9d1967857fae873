#include "calib/judge/plane_check.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/judge/triangulate.hpp"
#include "calib/target/homography.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr int kBlock_px = 5;
constexpr std::size_t kMinPoints = 100;
constexpr double kHalfPlane_mm = 8;
constexpr double kGrossSigmas = 5;
constexpr double kSlopePrior_um = 0.5;  // sigma of what bow and twist change from the near to the far end

/// Target places (mm) of camera pixels, by the dots.
class Ground {
 public:
  Ground(const PoseView& dots, const TargetDesign& target, double clearance_mm)
      : target_(target), clear_mm_(clearance_mm + target.radius_mm) {
    std::vector<Vector2d> image, place;
    for (const DotView& dot : dots.dots) {
      image.push_back(dot.camera_px);
      place.emplace_back(target.place(dot.dot).head<2>());
    }
    if (const auto h = fit_homography(image, place)) to_target_ = *h;
  }

  [[nodiscard]] bool contains(double u, double v) const {
    const Vector2d cell = cell_of(u, v);
    if (!(cell.x() > 0 && cell.y() > 0 && cell.x() < target_.cols - 1 && cell.y() < target_.rows - 1)) return false;
    const Vector2d nearest(std::round(cell.x()), std::round(cell.y()));
    return (cell - nearest).norm() * target_.pitch_mm > clear_mm_;
  }

  /// Height of the real board towards the camera, between four dots whose offsets are known; 0 for a perfect one.
  [[nodiscard]] double height_mm(double u, double v, const std::vector<Vec3d>& offsets) const {
    if (offsets.empty()) return 0;
    const Vector2d cell = cell_of(u, v);
    const int col = std::min(static_cast<int>(cell.x()), target_.cols - 2);
    const int row = std::min(static_cast<int>(cell.y()), target_.rows - 2);
    const double x = cell.x() - col, y = cell.y() - row;
    const auto at = [&](int c, int r) { return offsets[static_cast<std::size_t>(target_.index({c, r}))].z(); };
    return (1 - y) * ((1 - x) * at(col, row) + x * at(col + 1, row)) +
           y * ((1 - x) * at(col, row + 1) + x * at(col + 1, row + 1));
  }

 private:
  /// Column and row, fractional.
  [[nodiscard]] Vector2d cell_of(double u, double v) const {
    return map_point(to_target_, {u, v}) / target_.pitch_mm + 0.5 * Vector2d(target_.cols - 1, target_.rows - 1);
  }

  const TargetDesign& target_;
  double clear_mm_;
  Eigen::Matrix3d to_target_ = Eigen::Matrix3d::Zero();
};

struct GroundPoint {
  Vec3d place;
  double height_mm = 0;  ///< of the board there
  Vector2d camera_px{0, 0};
};

std::vector<GroundPoint> ground_points(const CoordinateMap& u, const Ground& ground, const RigState& rig,
                                       const Ripple& ripple) {
  std::vector<GroundPoint> points;
  const double start_mm = rig.T_cam_target.empty() ? 48.0 : rig.T_cam_target[0].translation().z();
  for (int v0 = 0; v0 + kBlock_px <= u.value_px.height(); v0 += kBlock_px) {
    for (int u0 = 0; u0 + kBlock_px <= u.value_px.width(); u0 += kBlock_px) {
      const double cu = u0 + 0.5 * (kBlock_px - 1), cv = v0 + 0.5 * (kBlock_px - 1);
      if (!ground.contains(cu, cv)) continue;
      double sum = 0;
      for (int y = v0; y < v0 + kBlock_px; ++y) {
        for (int x = u0; x < u0 + kBlock_px; ++x) {
          const double value = static_cast<double>(u.value_px(x, y));
          sum += value - ripple.at(0, value);
        }
      }
      const double mean = sum / (kBlock_px * kBlock_px);
      if (!std::isfinite(mean)) continue;
      points.push_back({triangulate(rig, camera_ray(rig.camera, cu, cv), mean, start_mm),
                        ground.height_mm(cu, cv, rig.dot_offsets_mm), Vector2d(cu, cv)});
    }
  }
  return points;
}

struct Flat {
  Vec3d middle;
  Eigen::Matrix3d axes;  // columns: in the plane along camera x, across, normal away from the camera
};

Flat best_plane(const std::vector<GroundPoint>& points) {
  Flat flat;
  flat.middle = Vec3d::Zero();
  for (const GroundPoint& p : points) flat.middle += p.place / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const GroundPoint& p : points) spread += (p.place - flat.middle) * (p.place - flat.middle).transpose();
  Vec3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  if (normal.z() < 0) normal = -normal;
  const Vec3d x = (Vec3d::UnitX() - normal.x() * normal).normalized();
  flat.axes << x, normal.cross(x), normal;
  return flat;
}

/// The points of a board as if it were flat: its own height taken off along the plane's normal.
void flatten(std::vector<GroundPoint>& points) {
  const Vec3d normal = best_plane(points).axes.col(2);
  for (GroundPoint& p : points) p.place += p.height_mm * normal;
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

}  // namespace

Result<PlaneCheck> check_plane(const PoseFrames& frames, const PoseView& dots, const TargetDesign& target,
                               const RigState& rig, const PixelNoise& image_noise, const Ripple& ripple,
                               double clearance_mm) {
  ENAMEL_TRY_ASSIGN(const CoordinateMap u, decode_coordinate(frames.along_u, rig.projector.width, image_noise));
  std::vector<GroundPoint> points = ground_points(u, Ground(dots, target, clearance_mm), rig, ripple);
  if (points.size() >= kMinPoints) {
    flatten(points);
    drop_gross(points);
  }
  if (points.size() < kMinPoints) {
    return fail(ErrorCode::kCalibrationPoses,
                fmt::format("pose {}: {} usable places on the ground between the dots", frames.name, points.size()));
  }
  const Flat flat = best_plane(points);
  Eigen::Matrix<double, 6, 6> h = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double squares = 0;
  std::vector<PlaneHeight> heights;
  heights.reserve(points.size());
  for (const GroundPoint& p : points) {
    const Vec3d q = flat.axes.transpose() * (p.place - flat.middle);
    const double x = q.x() / kHalfPlane_mm, y = q.y() / kHalfPlane_mm, z = 1e3 * q.z();
    const Eigen::Matrix<double, 6, 1> j = (Eigen::Matrix<double, 6, 1>() << 1, x, y, x * x, x * y, y * y).finished();
    h += j * j.transpose();
    b += j * z;
    squares += z * z;
    heights.push_back({p.camera_px, z});
  }
  const Eigen::Matrix<double, 6, 6> inverse = h.inverse();
  const Eigen::Matrix<double, 6, 1> fit = inverse * b;
  const double left = (squares - fit.dot(b)) / static_cast<double>(points.size() - 6);
  const auto sigma = [&](Eigen::Index i) { return std::sqrt(std::max(0.0, left * inverse(i, i))); };
  return PlaneCheck{.pose = frames.name,
                    .points = points.size(),
                    .depth_mm = flat.middle.z(),
                    .rms_um = std::sqrt(squares / static_cast<double>(points.size())),
                    .shape = {fit[3], fit[5], fit[4]},
                    .sigma = {sigma(3), sigma(5), sigma(4)},
                    .heights = std::move(heights)};
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
