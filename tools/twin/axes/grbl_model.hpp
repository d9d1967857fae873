// SIMULATION of a GRBL 1.1 controller with two axes behind a pseudo-terminal, with faults and a witness of what it did.
// Acceleration is left out: an axis runs at its feed, and takes 30 ms to stop at a feed hold.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "protocol/base/clock.hpp"
#include "protocol/base/rng.hpp"
#include "tools/twin/axes/pseudo_terminal.hpp"

namespace enamel::twin {

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

/// What the motors did last. Steps that a motor lost are no business of the controller's and not in here.
struct GrblMotion {
  HostTime at{};
  std::array<double, 2> from_home{};  ///< X and Y, units from where homing leaves them
  int homings = 0;                    ///< 0: the position is unknown
  int movements = 0;                  ///< begun so far, a line of the host each
};
/// Called on the model's thread at least at every millisecond that it gets; must not wait.
using GrblWitness = std::function<void(const GrblMotion&)>;

struct GrblModelSetup {
  std::string banner = "Grbl 1.1h ['$' for help]";  ///< empty: says nothing at all
  bool boots_on_open = true;                        ///< as an Arduino does
  int homing_alarm = 0;                             ///< ALARM:n instead of home
  bool is_locked_after_home = false;                ///< error:9 to every move
  std::map<int, double> settings = {};              ///< instead of the usual ones
  std::uint64_t seed = 1;
  GrblWitness witness = {};
};

/// Usual settings: 800 steps a unit, homing to the negative end, X 400 and Y 70 units of travel, 1 unit pulled off.
/// Members are thread-safe.
class GrblModel {
 public:
  /// Answers at once; real time by `clock`, which must outlive it.
  GrblModel(PseudoTerminal terminal, GrblModelSetup setup, Clock& clock);
  ~GrblModel();
  GrblModel(const GrblModel&) = delete;
  GrblModel& operator=(const GrblModel&) = delete;

  [[nodiscard]] const std::string& port() const { return terminal_.port(); }
  /// Happens when this share of a movement is done: of that of this number, counted from 1, or the first after it; 0:
  /// of the next.
  void arm(GrblFault fault, double share, int movement = 0);
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
  enum class State { kAlarm, kIdle, kRun, kHold, kHome, kDoor };
  struct Leg {
    std::array<double, 2> from{}, to{};
    double seconds = 0.0, done_s = 0.0;
  };

  void run();
  void tell(HostTime now) const;
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
  [[nodiscard]] std::array<double, 2> home() const;

  GrblModelSetup setup_;
  Clock& clock_;
  PseudoTerminal terminal_;
  std::map<int, double> settings_;
  Rng random_;
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
  int armed_movement_ = 0, homings_ = 0;
  std::atomic<bool> is_moving_{false}, moved_before_home_{false}, from_below_{false}, ends_{false};
  std::atomic<int> moves_{0};
  std::thread thread_;
};

}  // namespace enamel::twin
