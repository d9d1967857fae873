// Gates on a whole burst. None is tuned to data: each says what four frames of a surface, in this order, must look
// like.
#pragma once

#include "pipeline/algo/phase/closure.hpp"
#include "pipeline/algo/phase/phase.hpp"
#include "pipeline/algo/unwrap/links.hpp"

namespace enamel::algo {

/// Share of valid pixels whose fourth frame is A + S or A - S within half of |S| + half of B/2 and noise. Four
/// 90-degree frames in the right order give nearly 1 (only flips' blur and depth edges fall out); a permutation breaks
/// the identity over a good part of the fringe. Frame 3 saturated: not counted.
[[nodiscard]] double closure_share(const PhaseMaps& maps, const NoiseModel& noise);

/// Largest share of valid pixels, over all pairs of frames, at which two frames are the same within noise. 1 where a
/// frame was sent twice; 0.4 at most where fringes pass, at the noise where the mask ends. Frames 1 and 3 of mode T are
/// the same in half of the cells, so that a view of a single fringe may look like one frame twice; it has no code
/// either way.
[[nodiscard]] double repeated_share(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise);

/// Bursts whose frames may come up again: a camera's ring of buffers is no longer than their 32 frames, and what was
/// left over in a buffer is as old as the ring is long.
inline constexpr std::size_t kBurstsRemembered = 8;

/// Whether some frames of a burst, but not all, are a frame of one burst before it, byte for byte: left over in a
/// buffer. Noise lets no two exposures be alike. All four are alike where a burst was sent twice, or is drawn without
/// noise; frames of one level tell nothing. Views consistent; another size is another picture.
[[nodiscard]] bool has_stale_frame(const BurstView& burst, const BurstView& before) noexcept;

/// Whether one frame of the burst shows no picture where the others show one: over the valid pixels its level varies by
/// no more than its noise.
[[nodiscard]] bool has_blank_frame(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise);

/// What motion and second harmonic leave of the closure residual, as median over blocks. A frame k of another
/// time is off by a phase d: of the two columns B sin and B cos of the residual, which motion fills with opposite
/// signs, it fills but one, B (d/2) (sin + cos) beside an apparent motion. Light and texture that change during the
/// burst disturb that column as much as any other: `unrest` is their part where b = -1, to which an odd frame adds
/// none.
struct OddFrame {
  float shift_rad = 0;  ///< d
  float unrest = 0;     ///< of B, on the same scale as shift_rad
};
/// errors: motion, light and harmonic as far as they are known; block_px: of the blocks.
[[nodiscard]] OddFrame find_odd_frame(const PhaseMaps& maps, const PolarityMaps& polarity, const BurstErrors& errors,
                                      float black_dn, int block_px);

/// Share of valid horizontal neighbours whose phase changes in the direction of the rig's carrier. An odd permutation
/// of mode M's three phase frames turns the sign of the phase, and its code is as good as before (cos is even): only
/// this tells. Noise of 0.15 rad, the mask's limit, leaves 0.87 of a fringe of 26 px, and 0.13 of a turned one.
[[nodiscard]] double direction_share(const PhaseMaps& maps, const Carrier& carrier);

}  // namespace enamel::algo
