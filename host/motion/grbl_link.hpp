// Questions and answers with a GRBL 1.1 controller over its serial line; knows nothing of angles.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "host/motion/grbl_profile.hpp"
#include "host/motion/grbl_reply.hpp"
#include "host/motion/serial_port.hpp"

namespace enamel::motion {

/// How to wait for an `ok`.
struct GrblWait {
  Nanoseconds within{};
  /// The controller has to say something this often (it is asked for reports meanwhile); 0: it may be silent, as it is
  /// while homing.
  Nanoseconds silence{};
  std::function<Result<void>(const GrblStatus&)> watch = {};  ///< sees the reports; an error ends the wait
  const std::atomic<bool>* cancel = nullptr;                  ///< kCancelled when it becomes true
};

/// One thread at a time. An alarm or a restart of the controller is kAxesAlarm, every other error of it and
/// damaged lines are kAxes, each with its remedy.
class GrblLink {
 public:
  /// Waits for the banner, or asks for it by a soft reset when opening the port resets nothing.
  [[nodiscard]] static Result<std::unique_ptr<GrblLink>> open(const std::string& path, Nanoseconds banner_within,
                                                              Clock& clock);
  /// Sends a line and waits for `ok`.
  [[nodiscard]] Result<void> command(const std::string& line, const GrblWait& wait);
  [[nodiscard]] Result<GrblStatus> status(Nanoseconds within);
  [[nodiscard]] Result<GrblSettings> settings(Nanoseconds within);
  /// Feed hold, then reset, in at most Axes::kStandTime. True: it slowed down to a stand before the reset and answers
  /// since, so that the position is kept.
  [[nodiscard]] Result<bool> halt();
  /// At once, without slowing down: the position is lost.
  [[nodiscard]] Result<void> reset();
  [[nodiscard]] bool is_lost() const { return port_.is_lost(); }
  [[nodiscard]] const std::string& version() const { return version_; }

 private:
  GrblLink(SerialPort port, Clock& clock) : port_(std::move(port)), clock_(clock) {}
  [[nodiscard]] Result<void> greet(Nanoseconds banner_within);
  [[nodiscard]] Result<bool> await_banner(Nanoseconds within, std::string& heard);
  [[nodiscard]] Result<void> send(std::string_view bytes);
  /// The next reply, nothing when none came until then. Errors, alarms and restarts come as errors.
  [[nodiscard]] Result<std::optional<GrblReply>> next(HostTime until);
  /// Reads away what was said before; an alarm among it is an error.
  [[nodiscard]] Result<void> drain();
  [[nodiscard]] bool slow_down();

  SerialPort port_;
  Clock& clock_;
  std::string version_;
  int garbled_ = 0;  ///< damaged lines since the last command
};

}  // namespace enamel::motion
