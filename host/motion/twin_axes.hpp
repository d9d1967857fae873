// SIMULATION of the axes: no hardware, no waiting. The true angles carry errors that a real table has.
#pragma once

#include <array>
#include <atomic>

#include "host/motion/axes.hpp"
#include "host/motion/move_plan.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::motion {

/// Errors of one simulated axis. True angle = x + harmonic_deg[0] (cos x - 1) + harmonic_deg[1] sin x, where x is the
/// angle of the motor, what play and lost steps leave of it.
struct TwinAxisConfig {
  double backlash_deg = 0.05;            ///< play: coming from above the table stays this far above
  std::array<double, 2> harmonic_deg{};  ///< factors of cos x - 1 and sin x
  double step_deg = 1.0 / 800.0;         ///< of the motor, microsteps and gear included
  double lost_step_deg = 1.8;            ///< what lose_step() takes away
  AxisLimits travel{-1.0, 361.0};
};

struct TwinAxesConfig {
  TwinAxisConfig rot;
  TwinAxisConfig swing{.travel = {-31.0, 31.0}};
  double overshoot_deg = 0.5;
  double speed_deg_per_s = 15.0;
  bool has_encoder = false;         ///< read-back of the table itself; without one it is NaN
  double encoder_step_deg = 0.001;  ///< its resolution
  double read_tolerance_deg = 0.2;  ///< a read-back further from its target is a fault: more than play and harmonic
};

/// Harmonics of 0.02 degrees amplitude and random phase for both axes; play up to 0.05 degrees.
void draw_errors(TwinAxesConfig& config, Rng& rng);

/// Deterministic: time is counted, not waited for; a move that would take longer than `within` ends on its way.
class TwinAxes final : public Axes {
 public:
  explicit TwinAxes(const TwinAxesConfig& config) : config_(config) {}

  [[nodiscard]] AxesLimits limits() const override {
    return target_limits({config_.rot.travel, config_.swing.travel}, config_.overshoot_deg);
  }
  [[nodiscard]] AxesState state() const override { return state_; }
  [[nodiscard]] Result<void> home(Nanoseconds within) override;
  [[nodiscard]] Result<AxesPosition> move_to(const AxesAngles& target, Nanoseconds within) override;
  [[nodiscard]] Result<AxesPosition> position() override;
  [[nodiscard]] Result<void> stop() override { return {}; }
  void request_stop() noexcept override { stop_requested_ = true; }

  /// Where the simulated table stands: what a render shows.
  [[nodiscard]] AxesAngles true_angles() const;
  /// The next movement of this axis loses lost_step_deg of its way; an encoder shows it, nothing else does.
  void lose_rot_step() { rot_.to_lose_deg += config_.rot.lost_step_deg; }
  void lose_swing_step() { swing_.to_lose_deg += config_.swing.lost_step_deg; }

 private:
  struct Mechanics {
    double motor_deg = 0.0;
    double lost_deg = 0.0;  ///< where the motor believes it is, less where it is
    double to_lose_deg = 0.0;
    double table_deg = 0.0;  ///< behind the play, before the harmonic
  };
  static void drive(Mechanics& m, double to_deg, const TwinAxisConfig& config);
  [[nodiscard]] Result<void> run(const AxesAngles& target, double within_s);
  [[nodiscard]] AxesAngles read_back() const;

  TwinAxesConfig config_;
  Mechanics rot_;
  Mechanics swing_;
  AxesPlace place_;
  AxesState state_ = AxesState::kUnhomed;
  std::atomic<bool> stop_requested_{false};
};

}  // namespace enamel::motion
