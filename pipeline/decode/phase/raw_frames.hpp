// A burst's frames as they came, kept while a better idea of what is in them is tried. Private to pipeline/decode.
#pragma once

#include "pipeline/decode/phase/phase.hpp"

namespace enamel::pipeline {

/// Solved as if the projector were linear, before anything was undone.
struct RawFrames {
  Map<float> mean_dn, cosine_dn, sine_dn, code_dn;

  void keep(const PhaseMaps& maps) {
    mean_dn = maps.mean_dn, cosine_dn = maps.cosine_dn, sine_dn = maps.sine_dn, code_dn = maps.code_dn;
  }
};

}  // namespace enamel::pipeline
