#include "host/motion/grbl_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace enamel::motion {
namespace {

using std::chrono::milliseconds;

constexpr Nanoseconds kSilence = milliseconds(1000);
constexpr Nanoseconds kAnswer = milliseconds(1500);
constexpr double kPrintedDeg = 1e-3;  // of a unit: reports and targets have three and four decimals

Nanoseconds from_ms(double ms) { return Nanoseconds{static_cast<std::int64_t>(ms * 1e6)}; }

std::string move_line(const GrblProfile& p, const std::array<double, 2>& units, double feed) {
  // G53: machine coordinates, whatever work offset a program left behind. G94, G21, G90: units a minute, as set,
  // absolute.
  return fmt::format("G90 G21 G94 G53 G1 {}{:.4f} {}{:.4f} F{:.1f}", p.rot.letter, units[0], p.swing.letter, units[1],
                     feed);
}

}  // namespace

Result<std::unique_ptr<GrblAxes>> GrblAxes::open(const std::string& port, const GrblProfile& profile, Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto link, GrblLink::open(port, from_ms(profile.banner_ms), clock));
  std::unique_ptr<GrblAxes> axes(new GrblAxes(std::move(link), profile, clock));
  ENAMEL_TRY_ASSIGN(axes->settings_, axes->link_->settings(kAnswer));
  ENAMEL_TRY(check_settings(axes->settings_, profile));
  return axes;
}

double GrblAxes::same_deg() const {
  const auto of = [](const GrblAxisConfig& a) {
    return 0.75 / a.steps_per_deg + kPrintedDeg * std::abs(a.deg_per_unit);
  };
  return std::max(of(profile_.rot), of(profile_.swing));
}

AxesAngles GrblAxes::angles_of(const GrblStatus& status) const {
  return scale_.angles({status.mpos[letter_index(profile_.rot)], status.mpos[letter_index(profile_.swing)]});
}

bool GrblAxes::is_cancelled() { return stop_requested_.exchange(false); }

Result<void> GrblAxes::require_ready() const {
  switch (state_.load()) {
    case AxesState::kReady:
      return {};
    case AxesState::kLost:
      return fail(ErrorCode::kAxes, "the line to the axes is gone: connect the controller and open it again");
    default:
      return fail(ErrorCode::kAxes, "the position of the axes is unknown: home first");
  }
}

Error GrblAxes::stand_after(Error error) {
  const auto kept = link_->is_lost() ? Result<bool>(false) : link_->halt();
  place_.rot.is_from_below = place_.swing.is_from_below = false;
  if (link_->is_lost()) {
    state_ = AxesState::kLost;
  } else if (kept && *kept && error.code == ErrorCode::kCancelled) {
    // Asked to stop and slowed down without losing a step: the next move starts from where it stands.
    const auto status = link_->status(kAnswer);
    const bool is_known = status && status->has_mpos;
    if (is_known) {
      const AxesAngles at = angles_of(*status);
      place_ = {{at.rot_deg, false}, {at.swing_deg, false}};
    }
    state_ = is_known ? AxesState::kReady : AxesState::kUnhomed;
  } else {
    state_ = AxesState::kUnhomed;
  }
  if (!kept) error.detail += "; and the table could not be stopped: " + kept.error().detail;
  return error;
}

Result<void> GrblAxes::home(Nanoseconds within) {
  if (state_ == AxesState::kLost) return require_ready();
  if (is_cancelled()) return fail(ErrorCode::kCancelled, "axes");
  state_ = AxesState::kMoving;
  auto found = find_home(clock_.now() + within);
  if (found) {
    place_ = {{profile_.rot.home_deg, false}, {profile_.swing.home_deg, false}};
    state_ = AxesState::kReady;
    return {};
  }
  stop_requested_ = false;
  // While homing GRBL obeys nothing but the reset, and there is no position to keep.
  if (!link_->is_lost()) static_cast<void>(link_->reset());
  state_ = link_->is_lost() ? AxesState::kLost : AxesState::kUnhomed;
  return found;
}

Result<void> GrblAxes::find_home(HostTime deadline) {
  ENAMEL_TRY(link_->command("$H", {.within = deadline - clock_.now(), .cancel = &stop_requested_}));
  ENAMEL_TRY_ASSIGN(const GrblStatus status, link_->status(kAnswer));
  if (status.state != GrblState::kIdle || !status.has_mpos) {
    return fail(status.state == GrblState::kAlarm ? ErrorCode::kAxesAlarm : ErrorCode::kAxes,
                fmt::format("after homing the controller is in state {} {}: home again", grbl_state_name(status.state),
                            status.has_mpos ? "" : "and reports no machine position (set $10=1)"));
  }
  scale_.home_units = {status.mpos[letter_index(profile_.rot)], status.mpos[letter_index(profile_.swing)]};
  scale_.home_deg = {profile_.rot.home_deg, profile_.swing.home_deg};
  scale_.deg_per_unit = {profile_.rot.deg_per_unit, profile_.swing.deg_per_unit};
  return check_travel(settings_, profile_, scale_);
}

Result<AxesPosition> GrblAxes::move_to(const AxesAngles& target, Nanoseconds within) {
  ENAMEL_TRY(check_target(target, limits()));
  ENAMEL_TRY(require_ready());
  if (is_cancelled()) return fail(ErrorCode::kCancelled, "axes");
  state_ = AxesState::kMoving;
  auto read = go(target, clock_.now() + within);
  if (!read) {
    stop_requested_ = false;
    return tl::unexpected<Error>(stand_after(std::move(read).error()));
  }
  place_ = {{target.rot_deg, true}, {target.swing_deg, true}};
  state_ = AxesState::kReady;
  return AxesPosition{target, *read};
}

Result<AxesAngles> GrblAxes::go(const AxesAngles& target, HostTime deadline) {
  AxesAngles from{place_.rot.at_deg, place_.swing.at_deg};
  // Somebody at the controller's buttons, or a restart since, must not be taken for the place where we left it.
  ENAMEL_TRY(resting_angles(from, deadline));
  for (const AxesAngles& point : way_to(target, place_, {profile_.overshoot_deg, same_deg()})) {
    ENAMEL_TRY(run_leg(from, point, deadline));
    from = point;
  }
  return settle(target, deadline);
}

Result<void> GrblAxes::check_inside(const GrblStatus& status) const {
  if (status.state == GrblState::kAlarm || status.state == GrblState::kDoor || status.state == GrblState::kSleep) {
    return fail(ErrorCode::kAxesAlarm,
                fmt::format("the controller went into state {} in the move: clear the cause (switch, "
                            "door, sleep), home again",
                            grbl_state_name(status.state)));
  }
  if (!status.has_mpos) return {};
  const AxesAngles at = angles_of(status);
  const AxesLimits travel = profile_.travel();
  const double slack = same_deg();
  const auto is_in = [&](double deg, const AxisLimits& l) {
    return deg >= l.min_deg - slack && deg <= l.max_deg + slack;
  };
  if (is_in(at.rot_deg, travel.rot) && is_in(at.swing_deg, travel.swing)) return {};
  return fail(ErrorCode::kAxes,
              fmt::format("the table left its travel, at rotation {:.3f}, swing {:.3f} deg: a target was "
                          "altered on the line or somebody moved it; check the cable, home again",
                          at.rot_deg, at.swing_deg));
}

Result<void> GrblAxes::run_leg(const AxesAngles& from, const AxesAngles& to, HostTime deadline) {
  GrblWait wait{.within = std::min(kAnswer, Nanoseconds{deadline - clock_.now()}),
                .silence = kSilence,
                .watch = [this](const GrblStatus& s) { return check_inside(s); },
                .cancel = &stop_requested_};
  ENAMEL_TRY(link_->command(move_line(profile_, scale_.units(to), feed_units_per_min(from, to, profile_)), wait));
  // `ok` says that the line was taken, not that it was done; a dwell's `ok` comes after all movement has ended.
  wait.within = deadline - clock_.now();
  ENAMEL_TRY(link_->command("G4 P0.01", wait));
  return resting_angles(to, deadline).map([](const AxesAngles&) {});
}

Result<AxesAngles> GrblAxes::resting_angles(const AxesAngles& target, HostTime deadline) {
  if (clock_.now() >= deadline) return fail(ErrorCode::kAxes, "the time for the move is over: allow it longer");
  ENAMEL_TRY_ASSIGN(const GrblStatus status, link_->status(std::min(kAnswer, Nanoseconds{deadline - clock_.now()})));
  ENAMEL_TRY(check_inside(status));
  if (status.state != GrblState::kIdle) {
    return fail(ErrorCode::kAxes,
                fmt::format("the controller is in state {} where it should stand: another program or its "
                            "buttons moved it; home again",
                            grbl_state_name(status.state)));
  }
  if (!status.has_mpos) return fail(ErrorCode::kAxes, "the report carries no machine position: set $10=1");
  const AxesAngles at = angles_of(status);
  const double off = std::max(std::abs(at.rot_deg - target.rot_deg), std::abs(at.swing_deg - target.swing_deg));
  if (off <= same_deg()) return at;
  return fail(
      ErrorCode::kAxesStep,
      fmt::format("the table stands at rotation {:.3f}, swing {:.3f} deg instead of {:.3f}, {:.3f}: steps were lost "
                  "or a target altered; check load, driver current and cable, home again",
                  at.rot_deg, at.swing_deg, target.rot_deg, target.swing_deg));
}

Result<AxesAngles> GrblAxes::settle(const AxesAngles& target, HostTime deadline) {
  const HostTime rested = clock_.now() + from_ms(profile_.settle_ms);
  if (rested > deadline)
    return fail(ErrorCode::kAxes, "no time is left for the table to settle: allow the move longer");
  while (clock_.now() < rested) {
    if (stop_requested_) return fail(ErrorCode::kCancelled, "axes");
    clock_.sleep_until(std::min(rested, clock_.now() + milliseconds(20)));
  }
  return resting_angles(target, deadline);
}

Result<AxesPosition> GrblAxes::position() {
  ENAMEL_TRY(require_ready());
  const AxesAngles commanded{place_.rot.at_deg, place_.swing.at_deg};
  const auto read = resting_angles(commanded, clock_.now() + kAnswer);
  if (!read) return tl::unexpected<Error>(stand_after(read.error()));
  return AxesPosition{commanded, *read};
}

Result<void> GrblAxes::stop() {
  if (state_ == AxesState::kLost) return require_ready();
  stop_requested_ = false;
  const bool was_ready = state_ == AxesState::kReady;
  const auto kept = link_->halt();
  if (link_->is_lost()) {
    state_ = AxesState::kLost;
  } else if (!kept || !*kept || !was_ready) {
    state_ = AxesState::kUnhomed;
  }
  if (!kept) return tl::unexpected<Error>(kept.error());
  return {};
}

}  // namespace enamel::motion
