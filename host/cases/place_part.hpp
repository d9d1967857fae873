// Where one scanned part lies on another: found by surface features from anywhere, laid by their surfaces, and believed
// only where the surface proves it.
#pragma once

#include <utility>
#include <vector>

#include "host/cases/part_surface.hpp"
#include "host/cases/part_views.hpp"
#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/track/place_evidence.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// A part with its pictures: made once, laid on any number of others.
struct LaidPart {
  explicit LaidPart(Mesh mesh) : surface(std::move(mesh)), views(views_of(surface, ViewShape{})) {}
  PartSurface surface;
  std::vector<PartView> views;
};

struct PlaceConfig {
  pipeline::EvidenceConfig evidence = {};  ///< the rules by which a scan finds itself again, for parts too
  pipeline::PriorConfig prior = {};        ///< which directions are weak
  double near_mm = 1.0;                    ///< chosen: surface so near the other's, and not on it, contradicts it
  double near_deg = 60;                    ///< chosen: where it looks much the same way; cheek and tongue sides do not
  double seed_radius_mm = 9;               ///< derived: of a picture, its corners left out
  double seed_share = 0.6;                 ///< chosen: of a seed's surface that has to lie on the other's to be grown
  double strong_share = 0.9;               ///< chosen: seeds of more are hardly wrong; a wrong tooth's has 0.6 to 0.8
  std::size_t strong_seeds = 4;            ///< chosen: then no more are sought
  std::size_t most_grown = 10;             ///< chosen: seeds, those of the largest share
  double same_place_mm = 0.3;              ///< chosen: places nearer than this are one
  double max_sigma_mm = 0.05;  ///< chosen: at the part's far end; a bite is off by 50 um at worst (product §3)
};

/// T_fixed_moving as it was found and what speaks for it.
struct Placement {
  Pose T_fixed_moving = Pose::Identity();
  double area_mm2 = 0;     ///< of the moving part, on the fixed one's surface
  double consistency = 0;  ///< that / (that and what lies near the fixed surface without being it)
  double form_rms_mm = 0;  ///< of the mean distances of blocks of 0.9 mm
  double rms_mm = 0;       ///< of all distances on the surface
  /// One standard deviation, by the blocks: of the place in the middle of what overlaps, of the turn, of the worst
  /// placed point of either part.
  double sigma_mm = 0, sigma_rad = 0, far_sigma_mm = 0;
  int weak_directions = 0;  ///< that the overlap hardly holds
};

/// Errors: kQualityGate with the reason: nothing alike was found, too little overlaps, the surfaces contradict each
/// other (another patient's), the overlap does not hold the part, or two places do as well. Pure, deterministic,
/// thread-safe.
[[nodiscard]] Result<Placement> place_part(const LaidPart& moving, const LaidPart& fixed, const PlaceConfig& config);

/// Weighs a place; what place_part() believes. Pure.
[[nodiscard]] Placement weigh_placement(const PartSurface& moving, const PartSurface& fixed, const Pose& T_fixed_moving,
                                        const PlaceConfig& config);

}  // namespace enamel::host
