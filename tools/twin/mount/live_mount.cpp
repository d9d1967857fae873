#include "tools/twin/mount/live_mount.hpp"

#include <algorithm>
#include <cmath>

#include "tools/twin/degrees.hpp"

namespace enamel::twin {
namespace {

// A minute of moving at a word a millisecond: far more than a picture is late.
constexpr std::size_t kMostRests = 60'000;

double between(double a, double b, double share) { return a + share * (b - a); }

}  // namespace

LiveMount::LiveMount(const MountConfig& config, std::uint64_t seed, const LostStep& lost)
    : config_(drawn(config, seed)), seed_(seed), lost_(lost) {
  MountConfig still = config;
  still.stops.clear();
  mount_ = drive(still, seed).mount;
  rests_.push_back({});
}

double LiveMount::shaft_rad(std::size_t axis) const { return drives_[axis].behind_play_rad + drives_[axis].off_rad; }

void LiveMount::home(const MotorAngles& motors) {
  homings_ = motors.homings;
  for (std::size_t i = 0; i < 2; ++i) {
    drives_[i].motor_rad = drives_[i].behind_play_rad = kRadPerDeg * motors.deg[i];
    drives_[i].lost_rad = drives_[i].off_rad = 0;
    drives_[i].last_movement = motors.movements;
  }
}

void LiveMount::turn(std::size_t axis, double to_rad, int movement) {
  Drive& d = drives_[axis];
  if (movement != d.last_movement) {
    d.last_movement = movement;
    const double rms_deg = axis == 0 ? config_.rotation.stop_error_deg : config_.swing.stop_error_deg;
    d.off_rad = stop_error_rad(axis == 1, rms_deg, seed_, d.movements++);
    if (axis == 0 && lost_.movement > 0 && movement >= lost_.movement) {
      d.lost_rad += kRadPerDeg * (to_rad > d.motor_rad ? lost_.deg : -lost_.deg);
      lost_.movement = 0;
    }
  }
  d.motor_rad = to_rad;
  const double pushed = to_rad - d.lost_rad;
  const double play = axis == 0 ? mount_.rotation.backlash_rad : mount_.swing.backlash_rad;
  d.behind_play_rad = std::clamp(d.behind_play_rad, pushed, pushed + play);
}

void LiveMount::motors_at(const MotorAngles& motors) {
  const std::lock_guard lock(mutex_);
  if (motors.homings != 0 && motors.homings != homings_) {
    home(motors);
    rests_.back().until = std::max(rests_.back().until, motors.at - Nanoseconds{1});
  } else if (motors.homings != 0) {
    for (std::size_t i = 0; i < 2; ++i) {
      const double to_rad = kRadPerDeg * motors.deg[i];
      if (to_rad != drives_[i].motor_rad) turn(i, to_rad, motors.movements);
    }
  }
  const std::array motor{drives_[0].motor_rad, drives_[1].motor_rad};
  const std::array shaft{shaft_rad(0), shaft_rad(1)};
  Rest& last = rests_.back();
  if (last.motor_rad == motor && last.shaft_rad == shaft) {
    last.until = motors.at;
    return;
  }
  rests_.push_back({motors.at, motors.at, motor, shaft});
  if (rests_.size() > kMostRests) rests_.pop_front();
}

TableTruth LiveMount::at(HostTime t) const {
  const std::lock_guard lock(mutex_);
  const auto next = std::upper_bound(rests_.begin(), rests_.end(), t,
                                     [](HostTime when, const Rest& rest) { return when < rest.from; });
  const Rest& before = next == rests_.begin() ? *next : *std::prev(next);
  std::array<double, 2> motor = before.motor_rad, shaft = before.shaft_rad;
  TableTruth truth;
  truth.is_moving = next != rests_.end() && before.from == before.until;
  if (next != rests_.begin() && next != rests_.end() && t > before.until) {
    const double share =
        std::chrono::duration<double>(t - before.until) / std::chrono::duration<double>(next->from - before.until);
    for (std::size_t i = 0; i < 2; ++i) {
      motor[i] = between(motor[i], next->motor_rad[i], share);
      shaft[i] = between(shaft[i], next->shaft_rad[i], share);
    }
    truth.is_moving = true;
  }
  truth.stop = table_at(mount_, shaft);
  truth.stop.rot_cmd = motor[0];
  truth.stop.swing_cmd = motor[1];
  return truth;
}

}  // namespace enamel::twin
