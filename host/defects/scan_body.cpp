// A scan body against what its maker says: a cylinder with free radius fitted to its side.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/defects/detect.hpp"

namespace enamel::host::defects {
namespace {

constexpr double kBelowTopMm = 0.4;  // chosen: by judgement, the top's edge is rounded in a scan
constexpr double kSeenPart = 0.6;    // chosen: by judgement, of its height: gum may cover the rest
constexpr double kGateMm = 0.3;      // chosen: by judgement, farther from the cylinder it is the flat, or not it
constexpr double kGateSigmas = 4, kLeastGateMm = 0.06;  // chosen: by judgement, of what the fit leaves
constexpr int kSectors = 24, kRings = 6;

struct Cylinder {
  Vec3d p = Vec3d::Zero(), axis = Vec3d::UnitZ();  ///< of the top's middle, outwards
  double radius = 0;
};

struct SidePoint {
  Vec3d p, n;
};

/// Vertices about the mark whose normal points away from the axis.
std::vector<SidePoint> side_of(const Surface& s, const Cylinder& c, const ScanBodyForm& form, double gate_mm) {
  constexpr double kAcross = 0.3, kOutwards = 0.95;
  std::vector<SidePoint> out;
  for (std::size_t v = 0; v < s.mesh.vertices.size(); ++v) {
    const Vec3d p = s.mesh.vertices[v].cast<double>(), n = s.mesh.normals[v].cast<double>();
    const Vec3d d = p - c.p;
    const double z = c.axis.dot(d);
    if (z > -kBelowTopMm || z < -kSeenPart * form.height_mm || std::abs(n.dot(c.axis)) > kAcross) continue;
    const Vec3d r = d - z * c.axis;
    if (std::abs(r.norm() - c.radius) > gate_mm || n.dot(r.normalized()) < kOutwards) continue;
    out.push_back({p, n});
  }
  return out;
}

double off_mm(const SidePoint& at, const Cylinder& c) {
  const Vec3d d = at.p - c.p;
  return (d - c.axis * c.axis.dot(d)).norm() - c.radius;
}

/// Robust standard deviation of the radial deviations.
double spread_mm(const std::vector<SidePoint>& side, const Cylinder& c) {
  constexpr double kMadToSigma = 1.4826;
  std::vector<double> off;
  for (const SidePoint& at : side) off.push_back(std::abs(off_mm(at, c)));
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::ranges::nth_element(off, middle);
  return kMadToSigma * *middle;
}

/// One Gauss-Newton step over place (across the axis), direction and radius.
void refine(const std::vector<SidePoint>& side, Cylinder& c) {
  const Vec3d x = c.axis.unitOrthogonal(), y = c.axis.cross(x);
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
  for (const SidePoint& at : side) {
    const Vec3d d = at.p - c.p;
    const double z = c.axis.dot(d);
    const Vec3d u = (d - z * c.axis).normalized();
    const double error = (d - z * c.axis).norm() - c.radius;
    Eigen::Matrix<double, 5, 1> row;
    row << -u.dot(x), -u.dot(y), -z * u.dot(x), -z * u.dot(y), -1;
    normal += row * row.transpose();
    right -= row * error;
  }
  const Eigen::Matrix<double, 5, 1> step = normal.ldlt().solve(right);
  c.p += step[0] * x + step[1] * y;
  c.axis = (c.axis + step[2] * x + step[3] * y).normalized();
  c.radius += step[4];
}

/// From the mark: axis by the normals about it.
bool begin_at(const Surface& s, const ScanBodyMark& mark, Cylinder& out) {
  constexpr double kTopShare = 0.8;  // of the radius: the top's edge stays out of it
  const auto top = facing_about(s, mark.p_top_mm, kTopShare * mark.form.radius_mm);
  if (!top) return false;
  out.axis = top->axis;
  out.p = mark.p_top_mm + out.axis * out.axis.dot(top->middle - mark.p_top_mm);
  out.radius = mark.form.radius_mm;
  return true;
}

double missing_share(const std::vector<SidePoint>& side, const Cylinder& c, const ScanBodyForm& form) {
  const Vec3d x = c.axis.unitOrthogonal(), y = c.axis.cross(x);
  std::array<bool, static_cast<std::size_t>(kSectors) * kRings> seen{};
  for (const SidePoint& at : side) {
    const Vec3d d = at.p - c.p;
    const double turn = std::atan2(y.dot(d), x.dot(d)) / (2 * std::numbers::pi) + 0.5;
    const double down = (-c.axis.dot(d) - kBelowTopMm) / (kSeenPart * form.height_mm - kBelowTopMm);
    const auto i = std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1);
    const auto k = std::clamp(static_cast<int>(down * kRings), 0, kRings - 1);
    seen[static_cast<std::size_t>(i * kRings + k)] = true;
  }
  const double flat_share =
      form.flat_mm > 0 ? std::acos(std::min(form.flat_mm / form.radius_mm, 1.0)) / std::numbers::pi : 0.0;
  const auto count = static_cast<double>(std::ranges::count(seen, true));
  return std::max(0.0, 1 - count / ((1 - flat_share) * static_cast<double>(seen.size())));
}

}  // namespace

void check_scan_body(const Surface& s, const ScanBodyMark& mark, const InspectConfig& config,
                     std::vector<Defect>& out) {
  constexpr int kRounds = 14, kWideRounds = 4;
  constexpr std::size_t kFewest = 200;
  Defect d;
  d.kind = DefectClass::kScanBody;
  d.p_model_mm = mark.p_top_mm;
  d.limit = config.body_error_um;
  Cylinder c;
  std::vector<SidePoint> side;
  bool found = begin_at(s, mark, c);
  double gate_mm = 2 * kGateMm;
  for (int i = 0; i < kRounds && found; ++i) {
    side = side_of(s, c, mark.form, gate_mm);
    found = side.size() >= kFewest;
    if (!found) continue;
    refine(side, c);
    if (i >= kWideRounds) gate_mm = std::clamp(kGateSigmas * spread_mm(side, c), kLeastGateMm, kGateMm);
  }
  if (!found) {
    d.confidence = confidence_of(1);
    d.words = "no scan body is seen at its mark: dry it and scan it from all sides";
    out.push_back(std::move(d));
    return;
  }
  double squares = 0;
  for (const SidePoint& at : side) squares += off_mm(at, c) * off_mm(at, c);
  const double form_um = kDefectUmPerMm * std::sqrt(squares / static_cast<double>(side.size()));
  const double error_um = kDefectUmPerMm * std::abs(c.radius - mark.form.radius_mm);
  const double missing = missing_share(side, c, mark.form);
  const double ratio =
      std::max({error_um / config.body_error_um, form_um / config.body_form_um, missing / config.body_missing});
  if (ratio <= 1) return;
  d.value = error_um;
  d.size_mm2 = (1 - missing) * 2 * std::numbers::pi * c.radius * kSeenPart * mark.form.height_mm;
  d.confidence = confidence_of(ratio);
  d.words = fmt::format(
      "radius off by {:.0f} um, form by {:.0f} um rms, {:.0f} % of its side not seen: tighten and dry it, scan it from "
      "all sides, or take another",
      error_um, form_um, 100 * missing);
  out.push_back(std::move(d));
}

}  // namespace enamel::host::defects
