// BurstDecoder's first steps: phase of three frames, and whether it looks like fringes at all.
#include <algorithm>
#include <cmath>

#include "pipeline/decode/decode_buffers.hpp"
#include "pipeline/decode/mode_m/micro_gates.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/mode_t/closure_gates.hpp"
#include "pipeline/decode/mode_t/fast_motion.hpp"
#include "pipeline/decode/steps/burst_output.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"

namespace enamel::pipeline {

std::size_t count_of(const PhaseMaps& maps, PixelReject reason) noexcept { return count_of(maps.reject, reason); }

void BurstDecoder::solve_phase(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out) const {
  PhaseMaps& maps = workspace.buffers_->phase;
  NoiseModel& noise = out.diagnostics.noise;
  noise = noise_ ? noise_from_rig(*noise_, view.bit_depth) : noise_from_closure(view);
  auto& saturated = workspace.buffers_->saturated;
  saturated.clear();
  (micro_ ? compute_micro_phase : compute_phase)(view, noise, config_.phase, maps);
  if (!micro_) solve_saturated(view, noise, config_.phase, maps, saturated);
  copy_images(maps, noise, out);
}

/// Turns of neighbours against each other. The flood leaks where a cliff is one fringe high, which a code mends;
/// without one the surface is cut where it costs least.
void BurstDecoder::unwrap(DecodeWorkspace::Buffers& b) const {
  if (coded()) return flood(b.phase.phase_rad, b.links, b.flood);
  unwrap_by_least_cuts(b.phase, carrier_, config_.cuts, b.cuts, b.flood);
  for (std::size_t i = 0; i < b.phase.reject.size(); ++i)
    if (b.phase.reject[i] != PixelReject::kNone) b.flood.component[i] = -1;
}

bool BurstDecoder::looks_like_fringes(DecodeWorkspace& workspace, DecodeDiagnostics& diag) const {
  auto& b = *workspace.buffers_;
  (micro_ ? diag.direction_share : diag.closure_share) =
      micro_ ? direction_share(b.phase, carrier_) : closure_share(b.phase, diag.noise);
  reject_half_lit(b.phase.modulation_dn, b.phase.reject);
  compute_links(b.phase, carrier_, config_.links, b.links);
  // A picture one pixel wide has no pairs, and nothing that speaks against it.
  diag.linked_share = b.links.pairs > 0 ? static_cast<double>(b.links.linked) / static_cast<double>(b.links.pairs) : 1;
  reject_parted(b.saturated, b.links, b.phase.reject);
  reject_edges(b.links, b.phase);
  if (diag.linked_share < config_.min_linked_share) return false;
  return micro_ ? diag.direction_share >= config_.min_direction_share : diag.closure_share >= config_.min_closure_share;
}

/// Frames that do not go together: wrong ones, or clipped ones.
BurstVerdict BurstDecoder::mismatch(const PhaseMaps& maps) const {
  const std::size_t saturated = count_of(maps, PixelReject::kSaturated);
  const std::size_t lit = maps.reject.size() - count_of(maps, PixelReject::kDark) - count_of(maps, PixelReject::kNoisy);
  const bool clipped = static_cast<double>(saturated) > config_.max_saturated_share * static_cast<double>(lit);
  return clipped ? BurstVerdict::kSaturated : BurstVerdict::kPatternMismatch;
}

/// Frames that are not those of a surface at rest: too fast a motion, or the wrong frames. Mode M's four
/// values a pixel are explained by some motion and order whatever they are, so that only its measured motion can tell.
/// Motion leaves neighbours linked.
BurstVerdict BurstDecoder::mismatch_or_too_fast(DecodeWorkspace::Buffers& b, DecodeDiagnostics& diag) const {
  if (micro_ || diag.linked_share < config_.min_linked_share) return mismatch(b.phase);
  const FastMotion motion = explain_by_motion(b.phase);
  const bool fast =
      motion.share >= config_.min_moving_share && std::abs(motion.motion_rad) >= config_.least_fast_motion_rad;
  if (!fast) return mismatch(b.phase);
  diag.motion_rad = static_cast<float>(motion.motion_rad);
  return BurstVerdict::kTooFast;
}

}  // namespace enamel::pipeline
