// One tooth crown as an implicit solid. Sizes and form after the tables of dental anatomy textbooks (Wheeler).
// Tooth coordinates: origin at the neck's centre on the gum margin, x along the arch, y to the cheek, z occlusal, mm.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace enamel::twin {

enum class ToothKind : std::uint8_t { kIncisor, kCanine, kPremolar, kMolar };

/// What a dentist made of it.
enum class ToothWork : std::uint8_t { kNatural, kPrepared, kScanBody };

/// Values at heights 0, 1/4, 1/2, 3/4, 1 of the crown, relative to half the tooth's width or thickness.
using Profile = std::array<double, 5>;

struct Cusp {
  double x, y, z;      ///< tip, mm
  double slope = 0.6;  ///< fall per mm, away from the tip
};

/// A vertical depression of the side wall, continuing an occlusal groove.
struct SideGroove {
  double x;
  double side;  ///< +1 cheek, -1 tongue
  double depth;
};

struct ToothForm {
  ToothKind kind = ToothKind::kMolar;
  double mesiodistal = 10, buccolingual = 10, height = 7;
  bool square = false;                   ///< outline a super-ellipse of exponent 3, else 2.5
  Profile width{}, thickness{}, lean{};  ///< half width along x, half depth along y, offset of the axis along y
  std::vector<Cusp> cusps;
  std::vector<SideGroove> side_grooves;
  double rounding = 0.8;  ///< mm, between side and top
  ToothWork work = ToothWork::kNatural;
  double finish_edge_mm = 0;  ///< prepared: strip over which the shoulder's outer edge is rounded
  double flat_mm = 0;         ///< scan body: of its flat from the axis, towards the cheek
};

/// Where a tooth stands: p_tooth = R^T (p - origin).
struct PlacedTooth {
  ToothForm form;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double s = 0;  ///< arc length of its middle
};

struct ToothField {
  double crown = 0;   ///< signed distance to the crown, about right near the surface; negative inside
  double side = 0;    ///< the same to the neck and root, extended without a top: what the gum clings to
  double groove = 0;  ///< 0…1: in a fissure
};

/// p in tooth coordinates.
[[nodiscard]] ToothField evaluate_tooth(const ToothForm& form, const Eigen::Vector3d& p);

/// Smooth maximum and minimum, exact where |a - b| >= k.
[[nodiscard]] inline double smooth_max(double a, double b, double k) {
  const double h = k - (a > b ? a - b : b - a);
  return (a > b ? a : b) + (h > 0 ? h * h / (4.0 * k) : 0.0);
}
[[nodiscard]] inline double smooth_min(double a, double b, double k) { return -smooth_max(-a, -b, k); }
[[nodiscard]] inline double smooth_step(double x, double lo, double hi) {
  const double t = x <= lo ? 0.0 : (x >= hi ? 1.0 : (x - lo) / (hi - lo));
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace enamel::twin
