// One burst to one surface patch: phase, unwrapping, absolute order by the code, triangulation, normals.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "calib/model/rig.hpp"
#include "pipeline/decode/mode_m/micro_code.hpp"
#include "pipeline/decode/mode_m/micro_refit.hpp"
#include "pipeline/decode/mode_t/closure.hpp"
#include "pipeline/decode/mode_t/flip_blur.hpp"
#include "pipeline/decode/mode_t/polarity.hpp"
#include "pipeline/decode/motion/rigid_motion.hpp"
#include "pipeline/decode/phase/burst_view.hpp"
#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/steps/decoded_burst.hpp"
#include "pipeline/decode/triangulate/normals.hpp"
#include "pipeline/decode/unwrap/cut_costs.hpp"
#include "pipeline/decode/unwrap/links.hpp"
#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {

struct DecodeConfig {
  PhaseConfig phase;
  LinkConfig links;
  OrderConfig order;
  CutConfig cuts;  ///< of patterns without a code
  PolarityConfig polarity;
  ClosureConfig closure;
  FlipBlurConfig flips;
  TornConfig torn;
  RigidMotionConfig rigid;
  MicroRefitConfig micro_refit;
  int motion_passes = 2;  ///< the second sees slopes without the ripple that the first took off
  NormalConfig normals;
  /// Undo in-burst motion and the projector's second harmonic, both seen in the closure; in mode M undo motion, seen by
  /// the code frame, and let that frame join the phase.
  bool correct_closure = true;
  /// Undo the ripple that the projector's harmonics leave, self-calibrated per burst: sin 4phi, in mode M sin 3phi.
  bool correct_ripple = true;
  /// Used when the rig states none. A depth range is never assumed.
  std::optional<calib::DepthRange> depth_range_mm;
  std::size_t min_points = 1000;     ///< fewer cannot be registered
  double max_saturated_share = 0.2;  ///< of lit pixels; beyond it, clipping is what spoils a burst that does not close
  double min_linked_share = 0.75;    ///< see burst_gates.hpp
  double min_closure_share = 0.65;
  double min_unplaced_closure_share = 0.85;  ///< with less and no order found, the frames are to blame, not the code
  double min_direction_share = 0.65;
  double min_code_agreement = 0.95;           ///< five times the share of lying cells that order.hpp expects
  double max_repeated_share = 0.9;            ///< of lit pixels at which two frames are the same picture
  double max_unplaced_repeated_share = 0.6;   ///< mode M: with more and no order found, the frames are to blame, ...
  double min_unplaced_direction_share = 0.8;  ///< ... and with less of this
  float max_odd_shift_rad = 0.1F;      ///< of one frame against the others: bends the phase by a quarter of it, and ...
  float max_odd_over_unrest = 2.0F;    ///< ... stands out from what light and texture did during the burst
  float harmless_motion_rad = 0.05F;   ///< mode M: with more a frame, orders are asked again without the motion
  double clear_code_agreement = 0.97;  ///< mode M: with less, without the light that passed by as well
  double max_motion_rad = 0.32;   ///< mean of a burst, a frame: 0.3 (algorithms.md §9) and what it may be measured off
  double min_moving_share = 0.8;  ///< of pixels that close under a motion, for frames that do not close at rest
  double least_fast_motion_rad = 0.15;  ///< ... and this motion at least: with less it is not what spoils a burst
  double max_torn_share = 0.1;  ///< a foreign code can only be followed by jumping every few cells; surfaces do not
};

/// Memory that one caller (one thread) reuses from burst to burst.
class DecodeWorkspace {
 public:
  DecodeWorkspace();
  ~DecodeWorkspace();
  DecodeWorkspace(DecodeWorkspace&&) noexcept;
  DecodeWorkspace& operator=(DecodeWorkspace&&) noexcept;

  /// Called after each step with its name, for timing by whoever has a clock.
  std::function<void(const char* step)> on_step;

 private:
  friend class BurstDecoder;
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

/// Immutable: decode() is const and thread-safe, each thread with its own workspace and output.
class BurstDecoder {
 public:
  /// Bakes the rig's per-pixel geometry (about half a second for VGA). Errors: kPatternSet (mode multi, fringes along
  /// v), kPatternAmbiguous (a code that leaves orders of the depth range alike), kRigInvalid (no depth range given
  /// anywhere, or one of absurdly many fringes; geometry that does not determine depth; mode M without `noise`, which
  /// no closure residual can stand in for).
  [[nodiscard]] static Result<BurstDecoder> make(const calib::Rig& rig, const DecodeConfig& config = {});

  /// `out` keeps its memory. On rejection the maps that were reached are filled, the patch is empty (all NaN).
  /// before: the bursts before this one, as far as they are known (kBurstsRemembered of them are enough); a frame left
  /// over from one of them is told at once.
  void decode(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out,
              std::span<const BurstView> before = {}) const;

  /// The same with fresh memory.
  [[nodiscard]] DecodedBurst decode(const BurstView& view) const;

  [[nodiscard]] const RayDepth& rays() const noexcept { return *rays_; }
  [[nodiscard]] std::shared_ptr<const RayDepth> shared_rays() const noexcept { return rays_; }
  [[nodiscard]] const DecodeConfig& config() const noexcept { return config_; }

 private:
  BurstDecoder() = default;
  BurstVerdict run(const BurstView& view, std::span<const BurstView> before, DecodeWorkspace& workspace,
                   DecodedBurst& out) const;
  [[nodiscard]] BurstVerdict too_few_valid(const PhaseMaps& maps) const;
  template <class Step>
  void undo_errors(DecodeWorkspace::Buffers& buffers, DecodeDiagnostics& diagnostics, const Step& step) const;
  void solve_phase(const BurstView& view, DecodeWorkspace& workspace, DecodedBurst& out) const;
  bool looks_like_fringes(DecodeWorkspace& workspace, DecodeDiagnostics& diag) const;
  [[nodiscard]] BurstVerdict mismatch(const PhaseMaps& maps) const;
  BurstVerdict mismatch_or_too_fast(DecodeWorkspace::Buffers& buffers, DecodeDiagnostics& diagnostics) const;
  [[nodiscard]] bool coded() const noexcept { return micro_ || signs_.informative; }
  void unwrap(DecodeWorkspace::Buffers& buffers) const;
  BurstVerdict place(DecodeWorkspace& workspace, DecodedBurst& out) const;
  void label(DecodeWorkspace::Buffers& buffers, const NoiseModel& noise) const;
  float label_by_code(DecodeWorkspace::Buffers& buffers, const NoiseModel& noise) const;
  void label_less_motion(DecodeWorkspace::Buffers& buffers, DecodeDiagnostics& diagnostics) const;
  const Map<std::int16_t>& refine(DecodeWorkspace& workspace, DecodedBurst& out) const;

  std::shared_ptr<const RayDepth> rays_;
  CellSigns signs_;                 ///< of four-step modes; unused in mode M
  std::optional<MicroCode> micro_;  ///< mode M
  Carrier carrier_;
  std::optional<calib::NoiseValues> noise_;
  DecodeConfig config_;
};

}  // namespace enamel::pipeline
