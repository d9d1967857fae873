// SIMULATION of a GRBL 1.1 controller with two axes behind a pseudo-terminal, with faults and a witness of what it did.
// Acceleration is left out: an axis runs at its feed, and takes 30 ms to stop at a feed hold.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <utility>

namespace enamel::test {

enum class GrblFault {
  kNone,
  kHardLimit,    ///< a switch closes: ALARM:1
  kRestart,      ///< brown-out: the controller starts anew
  kPowerOff,     ///< stands and says nothing any more
  kUnplug,       ///< the line is gone, the axis runs on
  kHang,         ///< runs on and says nothing any more
  kNoise,        ///< every reply is damaged from now on
  kOneBadByte,   ///< one reply is damaged
  kLostOk,       ///< one `ok` does not arrive
  kShort,        ///< stops before its target and says where
  kWander,       ///< moves on after it was idle
  kOtherTarget,  ///< the line with the target was altered: another angle within the travel
  kFarTarget,    ///< the same, beyond the travel of the table but not the controller's
  kIdleInMove,   ///< reports Idle while it runs
  kOkInMove,     ///< `ok` to a dwell while it runs
  kDoor,         ///< the door input opens
};

struct GrblModelSetup {
  std::string banner = "Grbl 1.1h ['$' for help]";  ///< empty: says nothing at all
  bool boots_on_open = true;                        ///< as an Arduino does
  int homing_alarm = 0;                             ///< ALARM:n instead of home
  bool is_locked_after_home = false;                ///< error:9 to every move
  std::map<int, double> settings = {};              ///< instead of the usual ones
  unsigned seed = 1;
};

/// Usual settings: 800 steps a unit, homing to the negative end, X 400 and Y 70 units of travel, 1 unit pulled off.
/// Members are thread-safe.
class GrblModel {
 public:
  explicit GrblModel(GrblModelSetup setup = {});
  ~GrblModel();
  GrblModel(const GrblModel&) = delete;
  GrblModel& operator=(const GrblModel&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  /// Happens in the next movement, when this share of it is done.
  void arm(GrblFault fault, double share);
  /// What the controller keeps to itself.
  [[nodiscard]] bool is_moving() const { return is_moving_; }
  /// A move was sent while the position was unknown, obeyed or not.
  [[nodiscard]] bool was_told_to_move_before_home() const { return moved_before_home_; }
  [[nodiscard]] std::array<double, 2> position() const;  ///< of X and Y, units
  /// Lowest and highest place of X and Y ever since home.
  [[nodiscard]] std::pair<std::array<double, 2>, std::array<double, 2>> range() const;
  [[nodiscard]] bool came_from_below() const { return from_below_; }  ///< last movement of every axis was upwards
  [[nodiscard]] int moves() const { return moves_; }

 private:
  using Time = std::chrono::steady_clock::time_point;
  enum class State { kAlarm, kIdle, kRun, kHold, kHome, kDoor };
  struct Leg {
    std::array<double, 2> from{}, to{};
    double seconds = 0.0, done_s = 0.0;
  };

  void run();
  void take(char c);
  void obey(const std::string& line);
  void begin_move(const std::string& line);
  void step(double dt);
  void strike(GrblFault fault);
  void end_leg(double share);
  void boot();
  void soft_reset();
  void report();
  void say(std::string line);
  [[nodiscard]] double setting(int number) const { return settings_.at(number); }

  GrblModelSetup setup_;
  std::string port_;
  int master_ = -1;
  std::map<int, double> settings_;
  std::mt19937 random_;
  mutable std::mutex mutex_;  ///< of all below but the atomics
  State state_ = State::kAlarm;
  std::string line_;
  Leg leg_;
  std::array<double, 2> at_{}, low_{}, high_{};
  double hold_s_ = 0.0, home_s_ = 0.0, wander_s_ = -1.0;
  bool dwells_ = false, is_homed_ = false, is_silent_ = false, lies_idle_ = false;
  int bad_lines_ = 0, lost_oks_ = 0;
  GrblFault armed_ = GrblFault::kNone;
  double armed_share_ = 0.0;
  std::atomic<bool> is_moving_{false}, moved_before_home_{false}, from_below_{false}, ends_{false};
  std::atomic<int> moves_{0};
  std::thread thread_;
};

}  // namespace enamel::test
