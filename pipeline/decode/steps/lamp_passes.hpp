// Light that changed by itself is told from motion, and motion without such light, in turn: what both pattern modes do
// with phase/light_change.hpp. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/phase/chosen.hpp"
#include "pipeline/decode/phase/light_change.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"

namespace enamel::pipeline {

/// find(LampLight): asks the burst as it stands, into `light`, whether light changed. take_off(): less what was found,
/// with the motion found anew. A burst without such light is left alone.
template <class Find, class TakeOff>
void undo_lamp(const LightChange& light, const Find& find, const TakeOff& take_off, DecodeDiagnostics& diagnostics) {
  const bool changed = find(LampLight::kAsSurface);
  diagnostics.light_ripple_rad = light.ripple_rad(), diagnostics.light_proof = light.proof();
  if (!changed) return;
  const double as_surface = light.misfit();
  const bool even = find(LampLight::kEven) && light.misfit() < as_surface;
  const LampLight of = even ? LampLight::kEven : LampLight::kAsSurface;
  for (int pass = 0; pass < kLightPasses && find(of); ++pass) take_off();
}

}  // namespace enamel::pipeline
