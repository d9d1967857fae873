// A reference loop: plain projective TSDF update (Curless and Levoy 1996, as in KinectFusion) of a dense grid, no
// weights by angle or noise, no carving, no colour.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/bench/speed/float_lens.hpp"
#include "tests/bench/speed/peers.hpp"

namespace enamel::bench {
namespace {

constexpr int kCell = 8;    ///< voxels along an edge of a cell
constexpr int kStride = 2;  ///< every second pixel marks cells: two are 0.1 mm apart, a cell is 0.8 mm wide

struct Voxel {
  float distance_mm = 0;
  float weight = 0;
};

/// A box of voxels in the model frame; voxel (i, j, k) at origin + voxel_mm * (i, j, k).
class Grid {
 public:
  Grid(const std::vector<PlacedPatch>& patches, double voxel_mm, double truncation_mm)
      : voxel_mm_(static_cast<float>(voxel_mm)), truncation_mm_(static_cast<float>(truncation_mm)) {
    Eigen::AlignedBox3d box;
    for (const PlacedPatch& placed : patches) {
      for (const Vec3f& p : placed.patch.points.pixels()) {
        if (std::isfinite(p.x())) box.extend(placed.T_model_cam * p.cast<double>());
      }
    }
    const Vec3d margin = Vec3d::Constant(truncation_mm + kCell * voxel_mm);
    origin_ = (box.min() - margin).cast<float>();
    cells_ = ((box.max() - box.min() + 2 * margin) / (voxel_mm * kCell)).array().ceil().cast<int>().matrix();
    voxels_.resize(static_cast<std::size_t>(cells_.prod()) * kCell * kCell * kCell);
    marked_.resize(static_cast<std::size_t>(cells_.prod()));
  }

  /// Voxels written.
  std::size_t integrate(const FloatLens& lens, const PlacedPatch& placed) {
    mark(placed);
    const Pose T_cam_model = placed.T_model_cam.inverse();
    std::size_t written = 0;
    for (const int cell : near_) written += update(lens, placed.patch.depth_mm, T_cam_model, cell);
    return written;
  }

  /// Distance at a point of the model frame, between the eight voxels about it; NaN where one is missing.
  [[nodiscard]] float at(const Vec3d& p) const {
    const Vec3f at = (p.cast<float>() - origin_) / voxel_mm_;
    const Eigen::Vector3i low = at.array().floor().cast<int>();
    const Vec3f part = at - low.cast<float>();
    float sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3i up(corner & 1, corner >> 1 & 1, corner >> 2);
      const Voxel& voxel = voxel_at(low + up);
      if (!(voxel.weight > 0)) return std::numeric_limits<float>::quiet_NaN();
      const Vec3f share = (up.array() == 1).select(part, Vec3f::Ones() - part);
      sum += share.prod() * voxel.distance_mm;
    }
    return sum;
  }

 private:
  [[nodiscard]] int cell_of(const Eigen::Vector3i& c) const {
    return (c.z() * cells_.y() + c.y()) * cells_.x() + c.x();
  }
  [[nodiscard]] static std::size_t first_of(int cell) { return static_cast<std::size_t>(cell) * kCell * kCell * kCell; }

  [[nodiscard]] const Voxel& voxel_at(const Eigen::Vector3i& v) const {
    const Eigen::Vector3i c = v / kCell, in = v - kCell * c;
    return voxels_[first_of(cell_of(c)) + static_cast<std::size_t>((in.z() * kCell + in.y()) * kCell + in.x())];
  }

  void mark(const PlacedPatch& placed) {
    for (const int cell : near_) marked_[static_cast<std::size_t>(cell)] = 0;
    near_.clear();
    const Map<Vec3f>& points = placed.patch.points;
    const Eigen::Isometry3f T = placed.T_model_cam.cast<float>();
    for (int v = 0; v < points.height(); v += kStride) {
      for (int u = 0; u < points.width(); u += kStride) {
        const Vec3f& p = points(u, v);
        if (!std::isfinite(p.x())) continue;
        const Vec3f along = p * (truncation_mm_ / p.z());
        for (const Vec3f& q : {Vec3f(p - along), p, Vec3f(p + along)}) mark_at(T * q);
      }
    }
  }
  void mark_at(const Vec3f& p) {
    const Eigen::Vector3i c = ((p - origin_) / (voxel_mm_ * kCell)).array().floor().cast<int>();
    const int cell = cell_of(c);
    if (std::exchange(marked_[static_cast<std::size_t>(cell)], std::uint8_t{1}) == 0) near_.push_back(cell);
  }

  std::size_t update(const FloatLens& lens, const Map<float>& depth_mm, const Pose& T_cam_model, int cell) {
    const Eigen::Vector3i c(cell % cells_.x(), cell / cells_.x() % cells_.y(), cell / cells_.x() / cells_.y());
    const Vec3f corner = origin_ + voxel_mm_ * kCell * c.cast<float>();
    const Vec3f first = (T_cam_model * corner.cast<double>()).cast<float>();
    const Eigen::Matrix3f step = voxel_mm_ * T_cam_model.linear().cast<float>();
    Voxel* voxel = &voxels_[first_of(cell)];
    std::size_t written = 0;
    for (int k = 0; k < kCell; ++k) {
      for (int j = 0; j < kCell; ++j) {
        Vec3f p = first + static_cast<float>(k) * step.col(2) + static_cast<float>(j) * step.col(1);
        for (int i = 0; i < kCell; ++i, ++voxel, p += step.col(0)) {
          const int pixel = lens.pixel_of(p);
          if (pixel < 0) continue;
          const float distance = depth_mm[static_cast<std::size_t>(pixel)] - p.z();
          if (!(std::abs(distance) < truncation_mm_)) continue;  // also NaN
          voxel->distance_mm = (voxel->distance_mm * voxel->weight + distance) / (voxel->weight + 1.0F);
          voxel->weight += 1.0F;
          ++written;
        }
      }
    }
    return written;
  }

  float voxel_mm_, truncation_mm_;
  Vec3f origin_ = Vec3f::Zero();
  Eigen::Vector3i cells_ = Eigen::Vector3i::Zero();
  std::vector<Voxel> voxels_;  ///< cell after cell
  std::vector<std::uint8_t> marked_;
  std::vector<int> near_;  ///< cells of the last patch
};

double median_off_um(const Grid& grid, const PlacedPatch& placed) {
  std::vector<float> off;
  for (const Vec3f& p : placed.patch.points.pixels()) {
    if (!std::isfinite(p.x())) continue;
    const float d = std::abs(grid.at(placed.T_model_cam * p.cast<double>()));
    if (std::isfinite(d)) off.push_back(d);
  }
  if (off.empty()) return std::numeric_limits<double>::infinity();
  std::ranges::nth_element(off, off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2));
  return 1e3 * static_cast<double>(off[off.size() / 2]);
}

}  // namespace

TsdfLoopCost tsdf_loop(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches, double voxel_mm,
                       double truncation_mm, int repeats) {
  const FloatLens eye(lens);
  Grid grid(patches, voxel_mm, truncation_mm);
  const auto count = static_cast<double>(patches.size());
  TsdfLoopCost out;
  out.cost = least_of(repeats, patches.size(), [&] {
    std::size_t written = 0;
    for (const PlacedPatch& placed : patches) written += grid.integrate(eye, placed);
    out.voxels = static_cast<double>(written) / count;
  });
  out.off_um = median_off_um(grid, patches.back());
  return out;
}

}  // namespace enamel::bench
