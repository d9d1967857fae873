// The motors' side of the simulated controller: movements, homing and what goes wrong in them.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "tools/twin/axes/grbl_model.hpp"

namespace enamel::twin {
namespace {

constexpr double kWanderS = 0.004;  // after it stood

}  // namespace

void GrblModel::begin_move(const std::string& line) {
  double x = 0.0, y = 0.0, feed = 0.0;
  if (std::sscanf(line.c_str(), "G90 G21 G94 G53 G1 X%lf Y%lf F%lf", &x, &y, &feed) != 3) return say("error:2");
  // Noise on the way to the controller, which has no checksum to notice it by.
  if (armed_ == GrblFault::kOtherTarget) x = x < -200.0 ? x + 30.0 : x - 30.0;
  if (armed_ == GrblFault::kFarTarget) x = -5.0;
  if (armed_ == GrblFault::kOtherTarget || armed_ == GrblFault::kFarTarget) armed_ = GrblFault::kNone;
  const auto is_out = [](double v, double travel) { return v < -travel - 1e-6 || v > 1e-6; };
  if (setting(20) == 1.0 && (is_out(x, setting(130)) || is_out(y, setting(131)))) {
    state_ = State::kAlarm;
    return say("ALARM:2");
  }
  const std::array<double, 2> to{x, y};
  leg_ = {at_, to, std::hypot(x - at_[0], y - at_[1]) / feed * 60.0, 0.0};
  if (leg_.seconds > 0.0) {
    from_below_ = to[0] >= at_[0] && to[1] >= at_[1];
    state_ = State::kRun;
    is_moving_ = true;
    ++moves_;
  }
  say("ok");
}

void GrblModel::end_leg(double share) {
  for (std::size_t i = 0; i < 2; ++i) {
    at_[i] = leg_.from[i] + share * (leg_.to[i] - leg_.from[i]);
    low_[i] = std::min(low_[i], at_[i]);
    high_[i] = std::max(high_[i], at_[i]);
  }
}

void GrblModel::step(double dt) {
  if (state_ == State::kHome && (home_s_ -= dt) <= 0.0) {
    at_ = home();
    ++homings_;
    low_ = high_ = at_;
    is_homed_ = true;
    state_ = State::kIdle;
    say("ok");
  }
  const bool holds = state_ == State::kHold && hold_s_ > 0.0;
  if (state_ == State::kRun || holds) {
    leg_.done_s += dt;
    const double share = leg_.seconds > 0.0 ? std::min(1.0, leg_.done_s / leg_.seconds) : 1.0;
    end_leg(share);
    const bool is_due = armed_ != GrblFault::kNone && moves_ >= armed_movement_ && share >= armed_share_;
    if (is_due) strike(std::exchange(armed_, GrblFault::kNone));
    if (holds && (hold_s_ -= dt) <= 0.0) is_moving_ = false;
    if (state_ == State::kRun && share >= 1.0) {
      state_ = State::kIdle;
      is_moving_ = lies_idle_ = false;
    }
  }
  if (dwells_ && state_ == State::kIdle) {
    dwells_ = false;
    say("ok");
  }
  if (wander_s_ > 0.0 && state_ == State::kIdle && (wander_s_ -= dt) <= 0.0) at_[0] += 0.05;
}

void GrblModel::strike(GrblFault fault) {
  const auto halt = [&](State state) {
    state_ = state;
    is_moving_ = false;
  };
  switch (fault) {
    case GrblFault::kHardLimit:
      halt(State::kAlarm);
      is_homed_ = dwells_ = false;
      return say("ALARM:1");
    case GrblFault::kRestart:
      return boot();
    case GrblFault::kPowerOff:
      halt(State::kAlarm);
      is_silent_ = true;
      return;
    case GrblFault::kUnplug:
      terminal_.close();
      return;
    case GrblFault::kHang:
      is_silent_ = true;
      return;
    case GrblFault::kNoise:
      bad_lines_ = 1 << 30;
      return;
    case GrblFault::kOneBadByte:
      bad_lines_ = 1;
      return;
    case GrblFault::kLostOk:
      lost_oks_ = 1;
      return;
    case GrblFault::kShort:
      return halt(State::kIdle);
    case GrblFault::kWander:
      wander_s_ = kWanderS;
      return;
    case GrblFault::kIdleInMove:
      lies_idle_ = true;
      return;
    case GrblFault::kOkInMove:
      dwells_ = false;
      return say("ok");
    case GrblFault::kDoor:
      return halt(State::kDoor);
    default:
      return;
  }
}

}  // namespace enamel::twin
