// Gates on the four pictures of a burst, whatever the pattern mode: what frames of one surface must look like.
#pragma once

#include <cstddef>

#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Largest share of valid pixels, over all pairs of frames, at which two frames are the same within 2 sigma of noise,
/// over the 95 % of two exposures of one picture. 1 where a frame was sent twice; 0.4 where fringes pass, at the noise
/// where the mask ends. Frames 1 and 3 of mode T are
/// the same in half of the cells, so that a view of a single fringe may look like one frame twice; it has no code
/// either way.
[[nodiscard]] double repeated_share(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise);

/// Bursts whose frames may come up again. physical: a camera's ring of buffers is no longer than their 32 frames, and
/// what was left over in a buffer is as old as the ring is long.
inline constexpr std::size_t kBurstsRemembered = 8;

/// Whether some frames of a burst, but not all, are a frame of one burst before it, byte for byte: left over in a
/// buffer. Noise lets no two exposures be alike. All four are alike where a burst was sent twice, or is drawn without
/// noise; frames of one level tell nothing. Views consistent; another size is another picture.
[[nodiscard]] bool has_stale_frame(const BurstView& burst, const BurstView& before) noexcept;
/// Whether all frames are those of a burst before it, byte for byte: it came twice. Frames of one level tell nothing.
[[nodiscard]] bool is_repeated(const BurstView& burst, const BurstView& before) noexcept;

/// Whether one frame of the burst shows no picture where the others show one: over the valid pixels its level varies by
/// no more than its noise.
[[nodiscard]] bool has_blank_frame(const BurstView& view, const PhaseMaps& maps, const NoiseModel& noise);

}  // namespace enamel::pipeline
