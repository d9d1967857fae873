// Everything one burst decodes to: every intermediate map, the surface patch, the verdict and why.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "pipeline/decode/motion/rigid_motion.hpp"
#include "pipeline/decode/phase/noise_model.hpp"
#include "pipeline/decode/phase/phase_ripple.hpp"
#include "pipeline/decode/phase/pixel_reject.hpp"
#include "pipeline/decode/phase/waveform.hpp"
#include "pipeline/types/map.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/relative_surface.hpp"
#include "pipeline/types/sight.hpp"

namespace enamel::pipeline {

/// Whole-burst outcome. Anything but kAccepted is a rejection to be counted under its name, not an error.
enum class BurstVerdict : std::uint8_t {
  kAccepted,
  kFrameMismatch,    ///< frame size or depth is not the rig's
  kTooDark,          ///< hardly any pixel is lit
  kSaturated,        ///< most lit pixels are at full scale
  kPatternMismatch,  ///< frames permuted, or projected with other patterns than the rig's
  kNoCode,           ///< phase is there, but no region shows enough code to be placed
  kTooFewPoints,
  kNoFringes,  ///< lit, but without a pattern
  kTooFast,    ///< the surface moved on by more of a fringe from frame to frame than can be undone
};

[[nodiscard]] constexpr std::string_view name_of(BurstVerdict v) noexcept {
  constexpr std::array<std::string_view, 9> kNames = {"accepted",       "frame_size_mismatch",  "too_dark",
                                                      "saturated",      "pattern_set_mismatch", "no_code",
                                                      "too_few_points", "no_fringes",           "too_fast"};
  return kNames[static_cast<std::size_t>(v)];
}

/// Figures that the verdict and reports rest on.
struct DecodeDiagnostics {
  double linked_share = 0;    ///< neighbouring pixel pairs that follow the rig's fringe carrier
  double closure_share = 0;   ///< lit pixels whose fourth frame is as the other three predict it, A + S or A - S; in
                              ///< mode M placed pixels whose code frame is
  double repeated_share = 0;  ///< of lit pixels: two frames are the same there, for the pair most alike
  float odd_shift_rad = 0;    ///< by which one frame seems to be off the others
  std::optional<double> odd_share;        ///< mode M: of what nothing else explains, what one such frame does
  float exposure_step = 0;                ///< of A: by which single frames are brighter than motion and light explain
  std::optional<std::size_t> odd_blocks;  ///< mode T: that could be asked whether a frame is off the others
  float odd_sigma_rad = 0;         ///< what noise leaves of it in a block; not in mode M, which asks blocks that know
  float unrest = 0;                ///< what else motion and harmonic do not explain, on the same scale
  double light_ripple_rad = 0;     ///< of phase, by light that changed by itself, as it was found first
  double light_proof = 0;          ///< chi squared of that
  double direction_share = 0;      ///< neighbours whose phase changes in the carrier's direction
  double code_agreement = 0;       ///< of pixels in decided cells: code as labelled
  double withdrawn_share = 0;      ///< of pixels in decided cells: their region's code was not as labelled
  double torn_share = 0;           ///< of smooth borders between cells: labelling jumps there
  float motion_rad = 0;            ///< mean phase change per frame interval
  float motion_spread_rad = 0;     ///< rms of the phase change per frame interval over blocks; not in mode M, to which
                                   ///< permuted frames look like motion
  float harmonic = 0;              ///< projector's B2/B1, from the closure; not in mode M
  float flip_blur_rad = 0;         ///< sigma of projector's and camera's blur at the code's flips; not in mode M
  RigidMotion rigid;               ///< of the surface in the camera's frame, per frame interval
  PhaseRipple ripple;              ///< of four steps, as it was subtracted; not in mode M
  double ripple_by_depth_rad = 0;  ///< rms of what was subtracted beside it, because it changes with depth
  float third_rad = 0;             ///< mode M: a1 of the sin 3phi correction that was subtracted
  float code_shift_rad = 0;  ///< mode M: phase by which the code frame alone is off the other three, motion undone
  float code_turn_rad = 0;   ///< mode M: mean angle of the code against its orders
  Waveform wave;             ///< of the projector, as it was undone before the code was read; no harmonics: nothing was
  std::optional<Waveform> wave_shown;  ///< what the burst alone shows of it, however weak: to be learned from
  NoiseModel noise;
};

/// A figure of the diagnostics as reports print it.
struct Figure {
  std::string_view name;
  int digits = 0;  ///< behind the point
  std::vector<double> values;
  bool is_list = false;  ///< printed as a list, however many
};

struct DecodedBurst {
  BurstVerdict verdict = BurstVerdict::kFrameMismatch;
  Map<float> phase_rad;     ///< [-pi, pi), phase of the fringes' cosine; NaN where masked as unlit or noisy
  Map<std::uint8_t> order;  ///< floor(u_p / period_px), kNoOrder where no depth
  Map<PixelReject> reject;  ///< kNone exactly where the patch has depth
  std::array<std::size_t, kPixelRejects> counts{};  ///< pixels per PixelReject; sums to the image
  SurfacePatch patch;
  /// What is kRelative and large enough for the model to judge. Empty unless accepted; of a pattern without a code also
  /// filled with kNoCode, by three frames: all that such a burst can tell.
  RelativeSurface relative;
  Sight sight;
  DecodeDiagnostics diagnostics;

  [[nodiscard]] bool accepted() const noexcept { return verdict == BurstVerdict::kAccepted; }
};

}  // namespace enamel::pipeline
