#include "calib/solve/board_view.hpp"

#include <Eigen/LU>
#include <cmath>
#include <optional>

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr double kStated_px = 0.05;  // sigma of a corner before the residuals tell a better one
constexpr double kReach = 0.5;       // of a square
constexpr double kClear_px = 3;      // from an edge

/// Steps to the next column and row at a corner, px.
Eigen::Matrix2d steps_at(const std::vector<BoardCorner>& corners, const TargetDesign& target, const BoardCorner& at) {
  const auto corner = [&](int col, int row) {
    return corners[static_cast<std::size_t>(target.index({col, row}))].image_px;
  };
  const GridIndex g = target.grid(at.index);
  const int c = g.col + 1 < target.cols ? g.col : g.col - 1, r = g.row + 1 < target.rows ? g.row : g.row - 1;
  Eigen::Matrix2d steps;
  steps << corner(c + 1, g.row) - corner(c, g.row), corner(g.col, r + 1) - corner(g.col, r);
  return steps;
}

std::vector<ProjectorSample> samples_at(const Vector2d& corner, const Eigen::Matrix2d& steps, const CoordinateMap& u,
                                        const CoordinateMap& v) {
  std::vector<ProjectorSample> out;
  const Eigen::Matrix2d to_squares = steps.inverse();
  const double area = std::abs(steps.determinant());
  // Distances from the two edges through the corner, a square.
  const Vector2d clear(kClear_px * steps.col(1).norm() / area, kClear_px * steps.col(0).norm() / area);
  const int reach = static_cast<int>(std::ceil(kReach * (steps.col(0).norm() + steps.col(1).norm())));
  const int cu = static_cast<int>(std::lround(corner.x())), cv = static_cast<int>(std::lround(corner.y()));
  for (int y = cv - reach; y <= cv + reach; ++y) {
    for (int x = cu - reach; x <= cu + reach; ++x) {
      if (!u.value_px.contains(x, y)) continue;
      const Vector2d q = (to_squares * (Vector2d(x, y) - corner)).cwiseAbs();
      if (!(q.x() > clear.x() && q.y() > clear.y() && q.x() < kReach && q.y() < kReach)) continue;
      const Vector2d value(static_cast<double>(u.value_px(x, y)), static_cast<double>(v.value_px(x, y)));
      if (!value.allFinite()) continue;
      out.push_back(
          {{x, y}, value, {static_cast<double>(u.variance_px2(x, y)), static_cast<double>(v.variance_px2(x, y))}});
    }
  }
  return out;
}

}  // namespace

PoseView board_view(const std::string& name, const std::vector<BoardCorner>& corners, const TargetDesign& target,
                    const CoordinateMap& u, const CoordinateMap& v) {
  PoseView pose;
  pose.name = name;
  for (const BoardCorner& corner : corners) {
    DotView dot;
    dot.dot = corner.index;
    dot.ellipse.centre = corner.image_px;
    dot.camera_px = corner.image_px;
    dot.covariance_px2 = kStated_px * kStated_px * Eigen::Matrix2d::Identity();
    dot.samples = samples_at(corner.image_px, steps_at(corners, target, corner), u, v);
    const auto map = fit_local_map(dot.samples, dot.camera_px);
    if (!map) continue;
    dot.map = *map;
    pose.dots.push_back(std::move(dot));
  }
  return pose;
}

}  // namespace enamel::calib
