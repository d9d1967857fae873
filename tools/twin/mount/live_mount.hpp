// Where a mount's table stands at any instant while a controller drives its motors: what play, stop error, lost steps
// and harmonics make of their angles. SIMULATION ONLY.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>

#include "protocol/base/time.hpp"
#include "tools/twin/mount/mount.hpp"

namespace enamel::twin {

/// The motors of rotation and swing at an instant.
struct MotorAngles {
  HostTime at{};
  std::array<double, 2> deg{};
  int homings = 0;    ///< 0: nobody knows where the motors stand, and the table stays where it is
  int movements = 0;  ///< of the controller so far
};

/// The next movement of the rotation from this one on (counted from 1) loses so much of its way; 0: none does.
struct LostStep {
  int movement = 0;
  double deg = 1.8;
};

/// Where the table was at one instant.
struct TableTruth {
  StopTruth stop;  ///< rot_cmd, swing_cmd: the motors
  bool is_moving = false;
};

/// Thread-safe: one thread tells of the motors, others ask.
///
/// Play is mechanical here, whatever the scene's `approach` says: the shaft pushes the table up from below and takes it
/// down only after the play. Homing finds the table's own zero, so that lost steps end with it.
class LiveMount {
 public:
  LiveMount(const MountConfig& config, std::uint64_t seed, const LostStep& lost = {});

  /// Times do not decrease. A first word, and one after homing, is a leap.
  void motors_at(const MotorAngles& motors);
  /// At an instant not later than the last word (else that word's) and not long before it.
  [[nodiscard]] TableTruth at(HostTime t) const;
  /// Errors of the unit included.
  [[nodiscard]] const Mount& mount() const { return mount_; }

 private:
  struct Drive {
    double motor_rad = 0, lost_rad = 0, behind_play_rad = 0, off_rad = 0;
    std::uint64_t movements = 0;
    int last_movement = 0;  ///< the controller's, in which this axis moved last
  };
  /// The drives did not move from `from` until `until`; between two rests they went straight.
  struct Rest {
    HostTime from{}, until{};
    std::array<double, 2> motor_rad{}, shaft_rad{};
  };
  void home(const MotorAngles& motors);
  void turn(std::size_t axis, double to_rad, int movement);
  [[nodiscard]] double shaft_rad(std::size_t axis) const;

  MountConfig config_;
  Mount mount_;
  std::uint64_t seed_;
  LostStep lost_;
  mutable std::mutex mutex_;  // guards what follows
  std::array<Drive, 2> drives_;
  int homings_ = 0;
  std::deque<Rest> rests_;
};

}  // namespace enamel::twin
