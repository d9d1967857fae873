// The finish line of a prepared tooth: profiles through the stump's axis, and how sharply each turns at the shoulder's
// outer edge.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/defects/detect.hpp"

namespace enamel::host::defects {
namespace {

constexpr int kProfiles = 48;                    // chosen: one every 7.5 degrees
constexpr double kTopMm = 1.2;                   // chosen: by judgement, surface so near to the mark is the stump's top
constexpr double kFlatDeg = 25, kSteepDeg = 65;  // chosen: the edge turns through these; a shoulder slopes less
constexpr double kNearEdgeMm = 1.2;              // chosen: by judgement, wider is no edge
constexpr double kStripMm = 0.7;                 // chosen: by judgement, gum begins farther off
constexpr double kLeastShoulderMm = 0.3;

/// Piece of a profile: facet cut by the half-plane.
struct Cut {
  double rho, z, length, tilt_deg;  ///< tilt: of the normal from the axis, outwards positive
};

struct Frame {
  Vec3d origin, axis, x, y;
};

/// Axis: mean normal of the stump's top. None where nothing faces one way about the mark.
bool stand_on(const Surface& s, const Vec3d& top, Frame& out) {
  const auto facing = facing_about(s, top, kTopMm);
  if (!facing) return false;
  const Vec3d across = facing->axis.unitOrthogonal();
  out = {top, facing->axis, across, facing->axis.cross(across)};
  return true;
}

/// Facets cut by each of the half-planes.
std::vector<std::vector<Cut>> profiles(const Surface& s, const Frame& f, double reach_mm) {
  std::vector<std::vector<Cut>> out(kProfiles);
  constexpr double kTurn = 2 * std::numbers::pi;
  for (const auto& t : s.mesh.triangles) {
    std::array<Vec3d, 3> p;
    std::array<double, 3> angle{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d d = s.mesh.vertices[t[k]].cast<double>() - f.origin;
      p[k] = {f.x.dot(d), f.y.dot(d), f.axis.dot(d)};
      angle[k] = std::atan2(p[k].y(), p[k].x());
    }
    if (std::hypot(p[0].x(), p[0].y()) > reach_mm) continue;
    const auto [low, high] = std::ranges::minmax(angle);
    if (high - low > 0.5 * std::numbers::pi) continue;  // over the cut of atan2, or about the axis itself
    const auto first = static_cast<int>(std::ceil((low + std::numbers::pi) / kTurn * kProfiles));
    const auto last = static_cast<int>(std::floor((high + std::numbers::pi) / kTurn * kProfiles));
    const Vec3d n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (int i = first; i <= last && i < kProfiles; ++i) {
      const double a = i * kTurn / kProfiles - std::numbers::pi;
      const Vec3d across(-std::sin(a), std::cos(a), 0), along(std::cos(a), std::sin(a), 0);
      std::vector<Vec3d> ends;
      for (std::size_t k = 0; k < 3; ++k) {
        const double da = across.dot(p[k]), db = across.dot(p[(k + 1) % 3]);
        if ((da < 0) != (db < 0)) ends.emplace_back(p[k] + da / (da - db) * (p[(k + 1) % 3] - p[k]));
      }
      if (ends.size() != 2) continue;
      const Vec3d middle = 0.5 * (ends[0] + ends[1]);
      const double tilt = std::atan2(along.dot(n), n.z()) * 180 / std::numbers::pi;
      out[static_cast<std::size_t>(i)].push_back({along.dot(middle), middle.z(), (ends[1] - ends[0]).norm(), tilt});
    }
  }
  return out;
}

/// Where the profile's shoulder ends, outside: the first run of level pieces below the stump's top that is long enough.
const Cut* end_of_shoulder(const std::vector<Cut>& by_rho) {
  constexpr double kBelowTopMm = 1.0, kJumpMm = 0.2;
  const Cut* last = nullptr;
  double length = 0;
  for (const Cut& c : by_rho) {
    if (std::abs(c.tilt_deg) >= kFlatDeg || c.z > -kBelowTopMm) continue;
    const bool goes_on = last != nullptr && c.rho - last->rho < kJumpMm && std::abs(c.z - last->z) < kJumpMm;
    if (!goes_on && length >= kLeastShoulderMm) return last;
    length = goes_on ? length + c.length : c.length;
    last = &c;
  }
  return length >= kLeastShoulderMm ? last : nullptr;
}

/// Radius of the edge in which a profile's shoulder ends, mm; negative where it or what lies beyond is not seen.
double edge_radius_mm(std::vector<Cut> cuts) {
  constexpr double kInsideMm = 0.15, kBeyondMm = 0.3, kAboveMm = 0.1;
  std::ranges::stable_sort(cuts, {}, &Cut::rho);
  const Cut* end = end_of_shoulder(cuts);
  if (end == nullptr) return -1;
  double strip = 0;
  bool sees_beyond = false;
  for (const Cut& c : cuts) {
    const double off = std::hypot(c.rho - end->rho, c.z - end->z);
    sees_beyond = sees_beyond || (c.rho > end->rho - kInsideMm && c.z < end->z - kBeyondMm && off < kNearEdgeMm);
    const bool is_edge = c.tilt_deg >= kFlatDeg && c.tilt_deg <= kSteepDeg && off < kStripMm;
    if (is_edge && c.rho > end->rho - kInsideMm && c.z < end->z + kAboveMm) strip += c.length;
  }
  return sees_beyond ? strip / ((kSteepDeg - kFlatDeg) * std::numbers::pi / 180) : -1;
}

}  // namespace

void check_finish_line(const Surface& s, const PreparationMark& mark, const InspectConfig& config,
                       std::vector<Defect>& out) {
  constexpr std::size_t kFewest = kProfiles / 6;
  Frame frame;
  std::vector<double> radii;
  if (stand_on(s, mark.p_top_mm, frame)) {
    for (const auto& cuts : profiles(s, frame, mark.reach_mm))
      if (const double r = edge_radius_mm(cuts); r >= 0) radii.push_back(r);
  }
  Defect d;
  d.kind = DefectClass::kFinishLine;
  d.p_model_mm = mark.p_top_mm;
  d.limit = config.edge_radius_um;
  if (radii.size() < kFewest) {
    d.value = std::numeric_limits<double>::max();
    d.confidence = confidence_of(1);
    d.words = "no finish line is seen about this stump: lay the gum back, dry it and scan its edge again";
    out.push_back(std::move(d));
    return;
  }
  std::ranges::sort(radii);
  d.value = kDefectUmPerMm * radii[radii.size() / 2];
  if (d.value <= d.limit) return;
  d.confidence = confidence_of(d.value / d.limit);
  d.words = fmt::format(
      "the finish line is rounded to {:.0f} um on average, of {} profiles: lay the gum back, dry it and scan it again",
      d.value, radii.size());
  out.push_back(std::move(d));
}

}  // namespace enamel::host::defects
