// Four frames to phase. With frames I0…I3 = A + B cos(phi), A - B sin(phi), A - B cos(phi), A + b B sin(phi), b = +-1:
//   A = (I0+I2)/2,  C = (I0-I2)/2 = B cos(phi),  S3 = A - I1 = B sin(phi),  D = I3 - A = b B sin(phi)
// The first three frames alone give phi whatever the polarity b is; D then says b (docs/decode.md §2).
#pragma once

#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/pixel_reject.hpp"
#include "pipeline/types/map.hpp"

namespace enamel::pipeline {

struct PhaseConfig {
  /// The brightest frame must exceed black by so many sigma. derived: noise lifts a dark frame so far with a
  /// probability of 2.9e-7, less than one pixel of a VGA burst.
  float dark_sigmas = 5;
  /// chosen: by judgement. Of full scale; what is brighter may be clipped.
  float saturation = 0.97F;
  /// chosen: by judgement, as noise of 0.08 mm in depth at mid-range. Predicted of the three-frame solution; in mode
  /// T of all four frames (mode_t/faint.hpp).
  float max_sigma_rad = 0.15F;
};

/// Per-pixel maps of one burst, all of the camera's size. Values where reject != kNone are finite but mean nothing.
struct PhaseMaps {
  Map<float> mean_dn;        ///< A, raw DN (black included)
  Map<float> cosine_dn;      ///< C
  Map<float> sine_dn;        ///< S3; later the best estimate of B sin(phi)
  Map<float> code_dn;        ///< D; NaN where frame 3 is saturated
  Map<float> modulation_dn;  ///< B
  Map<float> phase_rad;      ///< [-pi, pi)
  Map<float> sigma_rad;      ///< one standard deviation of phase_rad
  Map<PixelReject> reject;

  void resize(int width, int height);
};

/// Three-frame solution and physical mask of every pixel. view must be consistent and of the maps' size.
void compute_phase(const BurstView& view, const NoiseModel& noise, const PhaseConfig& config, PhaseMaps& maps);

}  // namespace enamel::pipeline
