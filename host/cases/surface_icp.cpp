#include "host/cases/surface_icp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::host {
namespace {

constexpr std::size_t kFewest = 30;     // chosen: five for every unknown
constexpr double kWelschScale = 2.985;  // Holland & Welsch 1977: 95 % efficient
constexpr double kMadToSigma = 1.4826;
constexpr double kSigmaFloor_mm = 0.005;  // chosen: as SampleConfig::sigma_floor_mm
constexpr double kSmallStep_mm = 1e-5;    // derived: a hundredth of what a placement is known to

struct Match {
  Pairing pair;
  double area_mm2 = 0;
};

double robust_scale(const std::vector<Match>& matches) {
  std::vector<double> off;
  for (const Match& m : matches) off.push_back(std::fabs(m.pair.distance_mm));
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::ranges::nth_element(off, middle);
  return kWelschScale * std::max(kMadToSigma * *middle, kSigmaFloor_mm);
}

/// Length of the step.
double step(const std::vector<Match>& matches, const pipeline::PriorConfig& prior, Pose& T) {
  Vec3d centre = Vec3d::Zero();
  for (const Match& m : matches) centre += m.pair.point / static_cast<double>(matches.size());
  double spread2 = 0;
  for (const Match& m : matches) spread2 += (m.pair.point - centre).squaredNorm() / static_cast<double>(matches.size());
  const double rho_mm = std::max(1.0, std::sqrt(spread2)), scale = robust_scale(matches);
  pipeline::NormalSystem system;
  for (const Match& m : matches) {
    pipeline::Vector6 J;
    J << (m.pair.point - centre).cross(m.pair.normal) / rho_mm, m.pair.normal;
    const double off = m.pair.distance_mm / scale;
    system.add(J, m.pair.distance_mm, m.area_mm2 * std::exp(-off * off));
  }
  const pipeline::Vector6 x = pipeline::solve(system, pipeline::Vector6::Zero(), prior).x;
  T = pipeline::apply_motion(x, centre, rho_mm, T);
  return x.norm();
}

}  // namespace

Pairing pair_up(const SurfaceElement& element, const PartSurface& fixed, const Pose& T_fixed_moving, double within_mm,
                double max_normal_deg) {
  const Vec3d p = T_fixed_moving * element.point;
  const auto hit = fixed.nearest(p, within_mm);
  if (!hit || hit->border) return {};
  const double cosine = hit->normal.dot(T_fixed_moving.linear() * element.normal);
  if (cosine < std::cos(max_normal_deg * std::numbers::pi / 180)) return {};
  return {Pairing::kMet, p, hit->normal, hit->normal.dot(p - hit->point)};
}

bool lay_surface(const std::vector<SurfaceElement>& moving, const PartSurface& fixed, const SurfaceLayer& layer,
                 const pipeline::PriorConfig& prior, Pose& T_fixed_moving) {
  const double reach2 = layer.radius_mm * layer.radius_mm;
  for (int round = 0; round < layer.rounds; ++round) {
    std::vector<Match> matches;
    for (const SurfaceElement& e : moving) {
      if ((e.point - layer.middle).squaredNorm() > reach2) continue;
      const Pairing pair = pair_up(e, fixed, T_fixed_moving, layer.gate_mm, layer.max_normal_deg);
      if (pair.kind == Pairing::kMet) matches.push_back({pair, e.area_mm2});
    }
    if (matches.size() < kFewest) return false;
    if (step(matches, prior, T_fixed_moving) < kSmallStep_mm) break;
  }
  return true;
}

}  // namespace enamel::host
