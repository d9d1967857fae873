#include "host/cases/place_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "host/cases/surface_icp.hpp"
#include "pipeline/register/feature/surface_votes.hpp"

namespace enamel::host {
namespace {

constexpr double kAnywhere_mm = 1e6;

struct Seed {
  Pose T_fixed_moving = Pose::Identity();
  Vec3d middle = Vec3d::Zero();  ///< moving part's frame
  double share = 0;              ///< of what is near that lies on the other's surface
};

struct Meeting {
  double seen_mm2 = 0;  ///< of the elements, near the other's surface and turned like it
  double on_mm2 = 0;    ///< of those, on it
  [[nodiscard]] double share() const { return seen_mm2 > 0 ? on_mm2 / seen_mm2 : 0; }
};

Meeting meeting(const std::vector<SurfaceElement>& elements, const LaidPart& fixed, const Pose& T, double on_mm,
                const PlaceConfig& config) {
  Meeting out;
  for (const SurfaceElement& e : elements) {
    const Pairing pair = pair_up(e, fixed.surface, T, config.near_mm, config.near_deg);
    if (pair.kind == Pairing::kNone) continue;
    out.seen_mm2 += e.area_mm2;
    out.on_mm2 += std::fabs(pair.distance_mm) < on_mm ? e.area_mm2 : 0;
  }
  return out;
}

std::vector<SurfaceElement> round_about(const PartSurface& part, const Vec3d& middle, double radius_mm) {
  std::vector<SurfaceElement> out;
  for (const SurfaceElement& e : part.coarse())
    if ((e.point - middle).norm() < radius_mm) out.push_back(e);
  return out;
}

/// Nothing where too little of what is near the view's target lies on the other's surface. Most starts are wrong, and
/// each layer has to show that the next is worth its time.
std::optional<Seed> seed_at(const std::vector<SurfaceElement>& near, const LaidPart& fixed, const Pose& start,
                            const Vec3d& middle, const PlaceConfig& config) {
  Seed seed{start, middle, 0};
  if (meeting(near, fixed, start, 0.5, config).share() < config.seed_share) return std::nullopt;
  double on_mm = 0.3;
  for (const SurfaceLayer& layer :
       {SurfaceLayer{middle, kAnywhere_mm, 1.0, 60, 6}, SurfaceLayer{middle, kAnywhere_mm, 0.4, 45, 6}}) {
    if (!lay_surface(near, fixed.surface, layer, config.prior, seed.T_fixed_moving)) return std::nullopt;
    const Meeting met = meeting(near, fixed, seed.T_fixed_moving, on_mm, config);
    if (met.share() < config.seed_share) return std::nullopt;
    seed.share = met.share();
    on_mm = config.evidence.match_mm;
  }
  return seed;
}

/// Views are asked in an order that jumps about the part, so that the first seeds are not all of one tooth.
std::vector<Seed> seeds_of(const LaidPart& moving, const LaidPart& fixed, const PlaceConfig& config) {
  std::vector<pipeline::KnownFeatures> known;
  for (const PartView& view : fixed.views) known.push_back({view.features, view.T_part_view});
  std::vector<Seed> out;
  std::size_t strong = 0;
  constexpr std::size_t kJump = 7;
  for (std::size_t first = 0; first < kJump; ++first) {
    for (std::size_t k = first; k < moving.views.size() && strong < config.strong_seeds; k += kJump) {
      const PartView& view = moving.views[k];
      const std::vector<SurfaceElement> near = round_about(moving.surface, view.target, config.seed_radius_mm);
      for (const pipeline::PlaceHypothesis& place : pipeline::vote_for_places(view.features, known, {})) {
        const Pose start = place.T_model_cam * view.T_part_view.inverse();
        const auto seed = seed_at(near, fixed, start, view.target, config);
        if (!seed) continue;
        strong += seed->share >= config.strong_share ? 1U : 0U;
        out.push_back(*seed);
      }
    }
  }
  std::ranges::stable_sort(out, std::greater(), &Seed::share);
  if (out.size() > config.most_grown) out.resize(config.most_grown);
  return out;
}

/// From a seed outwards: what is far from it is only pulled in once what is near is laid.
Pose grown(const Seed& seed, const LaidPart& moving, const LaidPart& fixed, const PlaceConfig& config) {
  Pose T = seed.T_fixed_moving;
  for (double radius = 1.6 * config.seed_radius_mm; radius < 70; radius *= 1.6)
    lay_surface(moving.surface.coarse(), fixed.surface, {seed.middle, radius, 0.4, 45, 6}, config.prior, T);
  lay_surface(moving.surface.coarse(), fixed.surface, {seed.middle, kAnywhere_mm, 0.15, 30, 8}, config.prior, T);
  return T;
}

double apart_mm(const Pose& a, const Pose& b, const PartSurface& part) {
  double most = 0;
  for (const SurfaceElement& e : part.coarse()) most = std::max(most, (a * e.point - b * e.point).norm());
  return most;
}

/// Empty where it convinces.
std::string doubt_of(const Placement& p, const PlaceConfig& config) {
  const pipeline::EvidenceConfig& rule = config.evidence;
  if (p.area_mm2 < rule.min_area_mm2)
    return fmt::format("only {:.0f} mm2 lie on each other, and {:.0f} are needed", p.area_mm2, rule.min_area_mm2);
  if (p.consistency < rule.min_consistency)
    return fmt::format("the surfaces contradict each other: where they meet, {:.0f} % agree, and {:.0f} are needed",
                       1e2 * p.consistency, 1e2 * rule.min_consistency);
  if (p.form_rms_mm > rule.max_form_mm)
    return fmt::format("the surfaces are of different form: {:.0f} um rms, and {:.0f} are allowed", 1e3 * p.form_rms_mm,
                       1e3 * rule.max_form_mm);
  if (p.weak_directions > 0 || !(p.far_sigma_mm <= config.max_sigma_mm))
    return fmt::format(
        "the overlap does not determine the pose: {:.0f} um at the far end (one standard deviation), and "
        "{:.0f} are allowed",
        1e3 * p.far_sigma_mm, 1e3 * config.max_sigma_mm);
  return {};
}

}  // namespace

Result<Placement> place_part(const LaidPart& moving, const LaidPart& fixed, const PlaceConfig& config) {
  std::vector<Placement> places;
  for (const Seed& seed : seeds_of(moving, fixed, config)) {
    const Placement place = weigh_placement(moving.surface, fixed.surface, grown(seed, moving, fixed, config), config);
    const auto same = std::ranges::find_if(places, [&](const Placement& p) {
      return apart_mm(p.T_fixed_moving, place.T_fixed_moving, moving.surface) < config.same_place_mm;
    });
    if (same == places.end()) places.push_back(place);
  }
  if (places.empty()) return fail(ErrorCode::kQualityGate, "nothing alike was found on the two surfaces");
  const auto weight = [](const Placement& p) { return p.area_mm2 * p.consistency; };
  std::ranges::stable_sort(places, std::greater(), weight);
  Placement best = places.front();
  for (int round = 0; round < 2; ++round)
    lay_surface(moving.surface.fine(), fixed.surface, {Vec3d::Zero(), kAnywhere_mm, config.evidence.match_mm, 30, 10},
                config.prior, best.T_fixed_moving);
  best = weigh_placement(moving.surface, fixed.surface, best.T_fixed_moving, config);
  if (std::string doubt = doubt_of(best, config); !doubt.empty())
    return fail(ErrorCode::kQualityGate, std::move(doubt));
  for (std::size_t k = 1; k < places.size(); ++k)
    if (doubt_of(places[k], config).empty())
      return fail(ErrorCode::kQualityGate,
                  fmt::format("two places {:.1f} mm apart fit alike",
                              apart_mm(best.T_fixed_moving, places[k].T_fixed_moving, moving.surface)));
  return best;
}

}  // namespace enamel::host
