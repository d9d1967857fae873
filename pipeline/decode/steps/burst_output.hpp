// The output of one burst around its surface: memory, what is shown of a rejected burst, counts. Private to
// pipeline/decode.
#pragma once

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/steps/refined_phase.hpp"

namespace enamel::pipeline {

void resize_output(int width, int height, DecodedBurst& out);

/// Grey image and modulation: what is worth showing whatever becomes of the burst.
void copy_images(const PhaseMaps& maps, const NoiseModel& noise, DecodedBurst& out);

/// The same of pixels that were solved from other frames since.
void show_anew(const RefinedPhase& phase, const NoiseModel& noise, DecodedBurst& out);

/// Of a burst that came to no surface: the phase of three frames, NaN where unlit or noisy, and the masks.
void show_phase(const PhaseMaps& maps, DecodedBurst& out);

/// Of frames that are not the rig's: nothing.
void show_nothing(DecodedBurst& out);

/// No depth, points, normals, order; kRelative where there was nothing else against a pixel.
void withdraw_surface(DecodedBurst& out);

[[nodiscard]] std::size_t count_of(const Map<PixelReject>& reject, PixelReject reason) noexcept;

/// Fills counts and patch.valid_px.
void count_rejects(DecodedBurst& out);

}  // namespace enamel::pipeline
