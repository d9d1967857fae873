#include "host/motion/twin_axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace enamel::motion {
namespace {

constexpr double kRad = std::numbers::pi / 180.0;

double with_harmonic(double deg, const std::array<double, 2>& h) {
  return deg + h[0] * (std::cos(deg * kRad) - 1.0) + h[1] * std::sin(deg * kRad);
}

double seconds_of(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }

double larger_way(const AxesAngles& a, const AxesAngles& b) {
  return std::max(std::abs(a.rot_deg - b.rot_deg), std::abs(a.swing_deg - b.swing_deg));
}

AxesAngles between(const AxesAngles& a, const AxesAngles& b, double share) {
  return {a.rot_deg + share * (b.rot_deg - a.rot_deg), a.swing_deg + share * (b.swing_deg - a.swing_deg)};
}

void draw_axis(TwinAxisConfig& axis, Rng& rng) {
  constexpr double kAmplitudeDeg = 0.02;
  constexpr double kMostBacklashDeg = 0.05;
  const double phase = rng.uniform(0.0, 2.0 * std::numbers::pi);
  axis.harmonic_deg = {kAmplitudeDeg * std::cos(phase), kAmplitudeDeg * std::sin(phase)};
  axis.backlash_deg = rng.uniform(0.0, kMostBacklashDeg);
}

}  // namespace

void draw_errors(TwinAxesConfig& config, Rng& rng) {
  draw_axis(config.rot, rng);
  draw_axis(config.swing, rng);
}

void TwinAxes::drive(Mechanics& m, double to_deg, const TwinAxisConfig& config) {
  const double to = std::round(to_deg / config.step_deg) * config.step_deg;
  if (to != m.motor_deg && m.to_lose_deg != 0.0) {
    m.lost_deg += to > m.motor_deg ? m.to_lose_deg : -m.to_lose_deg;
    m.to_lose_deg = 0.0;
  }
  m.motor_deg = to;
  const double shaft = to - m.lost_deg;
  // The shaft pushes the table up from below, and takes it down only after the play.
  m.table_deg = std::clamp(m.table_deg, shaft, shaft + config.backlash_deg);
}

AxesAngles TwinAxes::true_angles() const {
  return {with_harmonic(rot_.table_deg, config_.rot.harmonic_deg),
          with_harmonic(swing_.table_deg, config_.swing.harmonic_deg)};
}

AxesAngles TwinAxes::read_back() const {
  if (!config_.has_encoder) return {};
  const AxesAngles at = true_angles();
  const auto quantised = [&](double deg) {
    return std::round(deg / config_.encoder_step_deg) * config_.encoder_step_deg;
  };
  return {quantised(at.rot_deg), quantised(at.swing_deg)};
}

Result<void> TwinAxes::home(Nanoseconds within) {
  if (stop_requested_.exchange(false)) return fail(ErrorCode::kCancelled, "axes");
  state_ = AxesState::kUnhomed;
  const double way_deg = larger_way({rot_.motor_deg, swing_.motor_deg}, {0.0, 0.0});
  if (way_deg / config_.speed_deg_per_s > seconds_of(within)) {
    return fail(ErrorCode::kAxes, "homing takes longer than allowed (simulation)");
  }
  // The switch is on the table: whatever was lost is found again.
  rot_ = swing_ = Mechanics{};
  place_ = {};
  state_ = AxesState::kReady;
  return {};
}

Result<void> TwinAxes::run(const AxesAngles& target, double within_s) {
  AxesAngles from{place_.rot.at_deg, place_.swing.at_deg};
  const double same_deg = 0.5 * std::min(config_.rot.step_deg, config_.swing.step_deg);
  for (const AxesAngles& point : way_to(target, place_, {config_.overshoot_deg, same_deg})) {
    const double needed_s = larger_way(from, point) / config_.speed_deg_per_s;
    const bool is_late = needed_s > within_s;
    const AxesAngles end = is_late ? between(from, point, within_s / needed_s) : point;
    drive(rot_, end.rot_deg, config_.rot);
    drive(swing_, end.swing_deg, config_.swing);
    if (is_late) {
      place_ = {{rot_.motor_deg, false}, {swing_.motor_deg, false}};
      return fail(ErrorCode::kAxes, "the move takes longer than allowed (simulation)");
    }
    within_s -= needed_s;
    from = point;
  }
  place_ = {{target.rot_deg, true}, {target.swing_deg, true}};
  return {};
}

Result<AxesPosition> TwinAxes::move_to(const AxesAngles& target, Nanoseconds within) {
  ENAMEL_TRY(check_target(target, limits()));
  if (state_ != AxesState::kReady) return fail(ErrorCode::kAxes, "the position of the axes is unknown: home first");
  if (stop_requested_.exchange(false)) return fail(ErrorCode::kCancelled, "axes");
  ENAMEL_TRY(run(target, seconds_of(within)));
  const AxesAngles read = read_back();
  if (config_.has_encoder && larger_way(read, target) > config_.read_tolerance_deg) {
    state_ = AxesState::kUnhomed;
    return fail(ErrorCode::kAxesStep,
                fmt::format("the table stands at rotation {:.3f}, swing {:.3f} deg instead of {:.3f}, "
                            "{:.3f}: steps were lost; home again (simulation)",
                            read.rot_deg, read.swing_deg, target.rot_deg, target.swing_deg));
  }
  return AxesPosition{target, read};
}

Result<AxesPosition> TwinAxes::position() {
  if (state_ != AxesState::kReady) return fail(ErrorCode::kAxes, "the position of the axes is unknown: home first");
  return AxesPosition{{place_.rot.at_deg, place_.swing.at_deg}, read_back()};
}

}  // namespace enamel::motion
