// The axes on a GRBL 1.1 controller.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "host/motion/axes.hpp"
#include "host/motion/grbl_link.hpp"
#include "host/motion/grbl_profile.hpp"
#include "host/motion/move_plan.hpp"

namespace enamel::motion {

/// `read` is the controller's step count: it knows where it sent the motor, not where the table is; a lost step does
/// not show in it. A fault in a move takes the position away: state kUnhomed, and only home() moves.
class GrblAxes final : public Axes {
 public:
  /// Speaks to the controller and compares its settings with the profile; nothing moves. kAxes, kAxesAlarm,
  /// kConfigValue.
  [[nodiscard]] static Result<std::unique_ptr<GrblAxes>> open(const std::string& port, const GrblProfile& profile,
                                                              Clock& clock);

  [[nodiscard]] AxesLimits limits() const override { return target_limits(profile_.travel(), profile_.overshoot_deg); }
  [[nodiscard]] AxesState state() const override { return state_.load(); }
  [[nodiscard]] Result<void> home(Nanoseconds within) override;
  [[nodiscard]] Result<AxesPosition> move_to(const AxesAngles& target, Nanoseconds within) override;
  [[nodiscard]] Result<AxesPosition> position() override;
  [[nodiscard]] Result<void> stop() override;
  void request_stop() noexcept override { stop_requested_.store(true); }

  [[nodiscard]] const std::string& version() const { return link_->version(); }
  [[nodiscard]] const GrblSettings& settings() const { return settings_; }

 private:
  GrblAxes(std::unique_ptr<GrblLink> link, GrblProfile profile, Clock& clock)
      : link_(std::move(link)), profile_(std::move(profile)), clock_(clock) {}
  [[nodiscard]] Result<void> find_home(HostTime deadline);
  [[nodiscard]] Result<AxesAngles> go(const AxesAngles& target, HostTime deadline);
  [[nodiscard]] Result<void> run_leg(const AxesAngles& from, const AxesAngles& to, HostTime deadline);
  [[nodiscard]] Result<AxesAngles> settle(const AxesAngles& target, HostTime deadline);
  [[nodiscard]] Result<AxesAngles> resting_angles(const AxesAngles& target, HostTime deadline);
  [[nodiscard]] Result<void> check_inside(const GrblStatus& status) const;
  [[nodiscard]] AxesAngles angles_of(const GrblStatus& status) const;
  [[nodiscard]] Result<void> require_ready() const;
  [[nodiscard]] bool is_cancelled();
  /// After an error in a move: the table stands, the state says what is known.
  [[nodiscard]] Error stand_after(Error error);
  [[nodiscard]] double same_deg() const;

  std::unique_ptr<GrblLink> link_;
  GrblProfile profile_;
  Clock& clock_;
  GrblSettings settings_;
  GrblScale scale_;
  AxesPlace place_;  ///< where the last movement led; valid in kReady
  std::atomic<AxesState> state_{AxesState::kUnhomed};
  std::atomic<bool> stop_requested_{false};
};

}  // namespace enamel::motion
