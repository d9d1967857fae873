// Gates on a whole burst that hold in every pattern mode. Each owns its limits.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/fringe_orders.hpp"
#include "pipeline/decode/unwrap/links.hpp"

namespace enamel::pipeline {

/// Whether enough pixels are lit, and what spoils a burst whose frames do not go together.
struct LightGate {
  /// chosen: by judgement. Fewer cannot be registered.
  std::size_t min_points = 1000;
  /// chosen: by judgement. Of lit pixels; beyond it, clipping is what spoils the burst.
  double max_saturated_share = 0.2;
};

/// Whether the four pictures can be those of one burst.
struct FramesGate {
  /// Of lit pixels at which two frames are the same picture. chosen: by judgement, between 0.4 where fringes
  /// pass and 1 where a frame was sent twice (frame_gates.hpp).
  double max_repeated_share = 0.9;
};

/// Whether a projector can have cast the waveform that the frames seem to show.
struct WaveGate {
  /// Of the third harmonic to the first. chosen: on drawn bursts: in order they show 0.07 at most, moving by 0.33 rad a
  /// frame 0.14, and with mode M's code frame in a phase frame's place 0.25 and more where DirectionGate tells nothing.
  double max_third = 0.2;
};

/// Whether neighbours follow the rig's fringe carrier.
struct LinkGate {
  double min_linked_share = 0.75;  ///< chosen: by judgement
};

/// Whether the code that the orders rest on is the rig's.
struct CodeGate {
  /// Of a burst. With less its regions are judged one by one, and those with less are decided no more. chosen: by
  /// judgement. Five times the share of lying cells that order.hpp expects.
  double sound_agreement = 0.95;
  /// With less the code is another one. chosen: by judgement. Foreign codes and frames of other times reach 0.88.
  double min_agreement = 0.9;
  /// chosen: by judgement. A foreign code can only be followed by jumping every few cells; surfaces do not.
  double max_torn_share = 0.1;
};

/// Whether one frame is of another time than the others, which bends the phase by a quarter of its shift, or exposed
/// otherwise.
struct OddFrameGate {
  /// chosen: on rendered sets, slow and turning, and on frames left over within them (docs/notes/decode-attempts.md,
  /// frames that do not belong together). The second: it stands out from what light and texture did during the burst.
  float max_shift_rad = 0.1F;
  float max_over_unrest = 2.0F;
  /// Of DecodeDiagnostics::unrest: no light changes by so many times the fringes it lights. chosen: on drawn bursts, of
  /// which true ones show 0.33 at most, by noise 1.6 in the dark, and permuted ones 7 where nothing else tells.
  float max_unrest = 3.0F;
  /// What a motion eps leaves of second order, light and texture that pass by. chosen: on rendered balls that turn.
  float max_over_motion = 0.4F;
  /// A frame that is brighter or darker by twice this, beside half of the noise. chosen: on drawn bursts and rendered
  /// sets, of which bright ones show 0.02 at most.
  float max_exposure_step = 0.03F;
  /// Of what motion, light and harmonics leave, where the mode tells it. chosen: by judgement. An odd frame leaves
  /// little else; what is not quite known of a surface's motion has no reason to look like one. It excuses no code that
  /// is not sound.
  double min_share = 1.0 / 3;
  double sound_agreement = 0.95;  ///< chosen: by judgement, as CodeGate's
  /// Where most of what is left is an odd frame's, less of a shift is proof. chosen: on drawn bursts.
  double most_share = 0.5;
  float max_proven_rad = 0.06F;
  float max_over_sigma = 1.0F;  ///< derived: the median of |noise| over blocks is 0.67 of its sigma
};

/// Whether the surface moved by less of a fringe than can be undone.
struct MotionGate {
  /// chosen: by judgement. Mean of a burst, a frame interval: 0.3 and its own error (docs/decode.md §8).
  double max_motion_rad = 0.32;
};

[[nodiscard]] std::size_t count_of(const PhaseMaps& maps, PixelReject reason) noexcept;

/// Why so few pixels are left that nothing can be decoded; nullopt: enough are.
[[nodiscard]] std::optional<BurstVerdict> too_few_valid(const PhaseMaps& maps, const LightGate& gate);

/// Frames that do not go together: wrong ones, or clipped ones.
[[nodiscard]] BurstVerdict mismatch(const PhaseMaps& maps, const LightGate& gate);

/// Whether the pictures are those of one burst: no frame left over from a burst before, none blank, no two the same.
/// Fills diagnostics.repeated_share, unless it is told before.
[[nodiscard]] bool frames_go_together(const BurstView& view, std::span<const BurstView> before, const PhaseMaps& maps,
                                      const FramesGate& gate, DecodeDiagnostics& diagnostics);

[[nodiscard]] bool could_be_projected(const DecodeDiagnostics& diagnostics, const WaveGate& gate) noexcept;

[[nodiscard]] bool follows_code(const DecodeDiagnostics& diagnostics, const CodeGate& gate) noexcept;

[[nodiscard]] bool has_odd_frame(const DecodeDiagnostics& diagnostics, const OddFrameGate& gate) noexcept;

/// The same where nothing proves it: enough to say why a burst has no surface, too little to take one away.
[[nodiscard]] bool may_have_odd_frame(const DecodeDiagnostics& diagnostics, const OddFrameGate& gate) noexcept;

/// How far the phase of valid horizontal neighbours changes in the direction of the rig's carrier: 1 where it does, 0
/// where it runs the other way, and as much whatever the noise, each pair counting by what its noise lets it tell. An
/// odd permutation of mode M's three phase frames turns the sign of the phase, and its code is as good as before (cos
/// is even): only this tells. Frames 1 and 3 of mode T in each other's place turn it wherever frame 3's sign is plus.
[[nodiscard]] double direction_share(const PhaseMaps& maps, const Carrier& carrier);

}  // namespace enamel::pipeline
