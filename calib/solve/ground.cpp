#include "calib/solve/ground.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/target/homography.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;

constexpr int kBlock_px = 5;
constexpr int kBlockPixels = kBlock_px * kBlock_px;
constexpr double kMedianOfGroundChi2 = 0.970;  // of chi² / 22 with 22 degrees of freedom: 25 pixels less a plane

/// Places on the grid of camera pixels, by the dots.
class Ground {
 public:
  Ground(const PoseView& dots, const TargetDesign& target, double clearance_mm)
      : target_(target), clear_mm_(clearance_mm + target.radius_mm) {
    std::vector<Vector2d> image, place;
    for (const DotView& dot : dots.dots) {
      image.push_back(dot.camera_px);
      place.emplace_back(target.place(dot.dot).head<2>());
    }
    to_target_ = fit_homography(image, place);
  }

  /// Column and row, fractional; empty on a dot, near its edge and beyond the outermost dots.
  [[nodiscard]] std::optional<Vector2d> cell_at(double u, double v) const {
    if (!to_target_) return {};
    const Vector2d cell =
        map_point(*to_target_, {u, v}) / target_.pitch_mm + 0.5 * Vector2d(target_.cols - 1, target_.rows - 1);
    if (!(cell.x() > 0 && cell.y() > 0 && cell.x() < target_.cols - 1 && cell.y() < target_.rows - 1)) return {};
    const Vector2d nearest(std::round(cell.x()), std::round(cell.y()));
    if (!((cell - nearest).norm() * target_.pitch_mm > clear_mm_)) return {};
    return cell;
  }

 private:
  const TargetDesign& target_;
  double clear_mm_;
  std::optional<Eigen::Matrix3d> to_target_;
};

struct Block {
  double mean = 0, variance = 0;
  double scatter = 0;  ///< mean square about the block's own plane
  Eigen::Vector4d ripple = Eigen::Vector4d::Zero();
};

/// NaN as mean where a pixel has no coordinate.
Block read_block(const CoordinateMap& u, int u0, int v0, double period_px) {
  Block b;
  double squares = 0, along = 0, across = 0;
  constexpr double kLever = 2.0 * kBlock_px * (1 + 4);  // sum of the squared places of one axis over the block
  constexpr int kHalf = kBlock_px / 2;
  const double reference = static_cast<double>(u.value_px(u0 + kHalf, v0 + kHalf));
  for (int y = -kHalf; y <= kHalf; ++y) {
    for (int x = -kHalf; x <= kHalf; ++x) {
      const std::size_t i = u.value_px.index(u0 + kHalf + x, v0 + kHalf + y);
      const double value = static_cast<double>(u.value_px[i]), d = value - reference;
      b.mean += d / kBlockPixels;
      b.variance += static_cast<double>(u.variance_px2[i]) / (kBlockPixels * kBlockPixels);
      b.ripple += Ripple::harmonics(value, period_px) / kBlockPixels;
      squares += d * d;
      along += d * x;
      across += d * y;
    }
  }
  const double left = squares - kBlockPixels * b.mean * b.mean - (along * along + across * across) / kLever;
  b.scatter = left / (kBlockPixels - 3);
  b.mean += reference;
  return b;
}

}  // namespace

std::vector<GroundSample> ground_samples(const CoordinateMap& u, const PoseView& dots, const TargetDesign& target,
                                         double period_px, double clearance_mm) {
  std::vector<GroundSample> out;
  std::vector<double> ratio;
  const Ground ground(dots, target, clearance_mm);
  for (int v0 = 0; v0 + kBlock_px <= u.value_px.height(); v0 += kBlock_px) {
    for (int u0 = 0; u0 + kBlock_px <= u.value_px.width(); u0 += kBlock_px) {
      const Vector2d middle(u0 + 0.5 * (kBlock_px - 1), v0 + 0.5 * (kBlock_px - 1));
      const auto cell = ground.cell_at(middle.x(), middle.y());
      if (!cell) continue;
      const Block block = read_block(u, u0, v0, period_px);
      if (!std::isfinite(block.mean)) continue;
      out.push_back({middle, block.mean, block.variance, block.ripple, *cell});
      ratio.push_back(block.scatter / (kBlockPixels * block.variance));
    }
  }
  if (out.empty()) return out;
  const auto half = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
  std::nth_element(ratio.begin(), half, ratio.end());
  for (GroundSample& s : out) s.variance_px2 *= *half / kMedianOfGroundChi2;
  return out;
}

void remove_ripple(const Ripple& ripple, std::vector<GroundSample>& ground) {
  if (!(ripple.period_px[0] > 0)) return;
  for (GroundSample& s : ground) {
    s.projector_u_px -= ripple.coefficients_px[0].dot(s.ripple);
    s.ripple.setZero();
  }
}

double board_height_mm(const TargetDesign& target, const Vector2d& cell, const std::vector<Vec3d>& offsets) {
  if (offsets.empty()) return 0;
  const int col = std::clamp(static_cast<int>(cell.x()), 0, target.cols - 2);
  const int row = std::clamp(static_cast<int>(cell.y()), 0, target.rows - 2);
  const double x = cell.x() - col, y = cell.y() - row;
  const auto at = [&](int c, int r) { return offsets[static_cast<std::size_t>(target.index({c, r}))].z(); };
  return (1 - y) * ((1 - x) * at(col, row) + x * at(col + 1, row)) +
         y * ((1 - x) * at(col, row + 1) + x * at(col + 1, row + 1));
}

}  // namespace enamel::calib
