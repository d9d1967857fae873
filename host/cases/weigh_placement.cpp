// What speaks for a placement, and how surely the overlap holds it.
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "host/cases/place_part.hpp"
#include "host/cases/surface_icp.hpp"

namespace enamel::host {
namespace {

constexpr int kFewestOfBlock = 8;         // chosen: of some twenty elements; fewer are a rim
constexpr double kBlockFloor_mm = 0.002;  // chosen: what calibration leaves on a block of any size
constexpr double kPatch_mm = 5;           // chosen: of a tooth's side; what is left by calibration is alike within it
constexpr double kUnknowns = 6;

struct Block {
  Vec3d point = Vec3d::Zero(), normal = Vec3d::Zero();
  double distance_mm = 0;
  int elements = 0;
};

class Blocks {
 public:
  explicit Blocks(double width_mm) : width_mm_(width_mm) {}
  void add(const Pairing& pair) {
    const Vec3d cell = (pair.point / width_mm_).array().floor();
    Block& b = blocks_[{cell.x(), cell.y(), cell.z()}];
    b.point += pair.point;
    b.normal += pair.normal;
    b.distance_mm += pair.distance_mm;
    ++b.elements;
  }
  /// Means of those that are full enough.
  [[nodiscard]] std::vector<Block> means() const {
    std::vector<Block> out;
    for (const auto& [cell, sums] : blocks_) {
      if (sums.elements < kFewestOfBlock || !(sums.normal.norm() > 0)) continue;
      out.push_back({sums.point / sums.elements, sums.normal.normalized(), sums.distance_mm / sums.elements, 1});
    }
    return out;
  }

 private:
  double width_mm_;
  std::map<std::array<double, 3>, Block> blocks_;
};

/// Of the unknowns, where distances are alike within a patch and not from one to the next: those that are left (the
/// cluster-robust covariance of Liang & Zeger 1986, enlarged for what the fit took out of few patches), and
/// kBlockFloor_mm that calibration leaves and the fit may have taken up.
class PatchSpread {
 public:
  void add(const Vec3d& point, const pipeline::Vector6& J, double distance_mm) {
    const Vec3d cell = (point / kPatch_mm).array().floor();
    Patch& patch = patches_[{cell.x(), cell.y(), cell.z()}];
    patch.pull += J * distance_mm;
    patch.floor += J * kBlockFloor_mm;
    H_ += J * J.transpose();
  }
  [[nodiscard]] pipeline::Matrix6 covariance() const {
    const auto count = static_cast<double>(patches_.size());
    const double enlarged = count / std::max(1.0, count - kUnknowns);
    pipeline::Matrix6 spread = pipeline::Matrix6::Zero();
    for (const auto& [cell, patch] : patches_)
      spread += enlarged * patch.pull * patch.pull.transpose() + patch.floor * patch.floor.transpose();
    const pipeline::Matrix6 inverse = H_.inverse();
    return inverse * spread * inverse;
  }

 private:
  struct Patch {
    pipeline::Vector6 pull = pipeline::Vector6::Zero(), floor = pipeline::Vector6::Zero();
  };
  std::map<std::array<double, 3>, Patch> patches_;
  pipeline::Matrix6 H_ = pipeline::Matrix6::Zero();
};

double worst_sigma_mm(const PartSurface& part, const Pose& T, const Vec3d& centre, double rho_mm,
                      const pipeline::Matrix6& C) {
  double worst2 = 0;
  for (const SurfaceElement& e : part.coarse()) {
    const Vec3d r = (T * e.point - centre) / rho_mm;
    Eigen::Matrix<double, 3, 6> J;
    J << 0, r.z(), -r.y(), 1, 0, 0, -r.z(), 0, r.x(), 0, 1, 0, r.y(), -r.x(), 0, 0, 0, 1;
    worst2 = std::max(worst2, (J * C * J.transpose()).trace());
  }
  return std::sqrt(worst2);
}

void add_sigmas(const std::vector<Block>& blocks, const PartSurface& moving, const PartSurface& fixed,
                const PlaceConfig& config, Placement& out) {
  Vec3d centre = Vec3d::Zero();
  for (const Block& b : blocks) centre += b.point / static_cast<double>(blocks.size());
  double spread2 = 0;
  for (const Block& b : blocks) spread2 += (b.point - centre).squaredNorm() / static_cast<double>(blocks.size());
  const double rho_mm = std::max(1.0, std::sqrt(spread2));
  const double sigma_mm = std::max(out.form_rms_mm, kBlockFloor_mm);
  pipeline::NormalSystem system;
  PatchSpread patches;
  for (const Block& b : blocks) {
    pipeline::Vector6 J;
    J << (b.point - centre).cross(b.normal) / rho_mm, b.normal;
    system.add(J, 0, 1 / (sigma_mm * sigma_mm));
    patches.add(b.point, J, b.distance_mm);
  }
  out.weak_directions = pipeline::solve(system, pipeline::Vector6::Zero(), config.prior).weak;
  const pipeline::Matrix6 C = system.H.inverse() + patches.covariance();
  out.sigma_rad = std::sqrt(C.topLeftCorner<3, 3>().trace()) / rho_mm;
  out.sigma_mm = std::sqrt(C.bottomRightCorner<3, 3>().trace());
  out.far_sigma_mm = std::max(worst_sigma_mm(moving, out.T_fixed_moving, centre, rho_mm, C),
                              worst_sigma_mm(fixed, Pose::Identity(), centre, rho_mm, C));
}

}  // namespace

Placement weigh_placement(const PartSurface& moving, const PartSurface& fixed, const Pose& T_fixed_moving,
                          const PlaceConfig& config) {
  const pipeline::EvidenceConfig& rule = config.evidence;
  Placement out;
  out.T_fixed_moving = T_fixed_moving;
  Blocks blocks(rule.block_mm);
  double against = 0, sum2 = 0;
  const double match_cos = std::cos(rule.match_deg * (std::numbers::pi / 180));
  for (const SurfaceElement& e : moving.fine()) {
    const Pairing pair = pair_up(e, fixed, T_fixed_moving, config.near_mm, config.near_deg);
    if (pair.kind == Pairing::kNone) continue;
    const bool alike = pair.normal.dot(T_fixed_moving.linear() * e.normal) > match_cos;
    if (std::fabs(pair.distance_mm) >= rule.match_mm) {
      against += e.area_mm2;
    } else if (alike) {  // turned away but on the surface: an edge, which says neither
      out.area_mm2 += e.area_mm2;
      sum2 += e.area_mm2 * pair.distance_mm * pair.distance_mm;
      blocks.add(pair);
    }
  }
  if (out.area_mm2 <= 0) return out;
  out.consistency = out.area_mm2 / (out.area_mm2 + against);
  out.rms_mm = std::sqrt(sum2 / out.area_mm2);
  const std::vector<Block> means = blocks.means();
  double form2 = 0;
  for (const Block& b : means) form2 += b.distance_mm * b.distance_mm / static_cast<double>(means.size());
  out.form_rms_mm = std::sqrt(form2);
  out.far_sigma_mm = kBlockFloor_mm * 1e6;
  if (means.size() > 6) add_sigmas(means, moving, fixed, config, out);
  return out;
}

}  // namespace enamel::host
