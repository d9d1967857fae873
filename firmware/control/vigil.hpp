// Who watches the program hears of it only while the acquisition lives: service manager and hardware watchdog.
#pragma once

#include "firmware/control/service_notice.hpp"
#include "firmware/hal/watchdog.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

/// One thread.
class Vigil {
 public:
  /// `hardware`: null where there is none, else outlives this. `limit`: of the acquisition's silence.
  Vigil(Watchdog* hardware, Nanoseconds limit) : hardware_(hardware), limit_(limit) { notice_.tell("READY=1"); }
  ~Vigil() { notice_.tell("STOPPING=1"); }
  Vigil(const Vigil&) = delete;
  Vigil& operator=(const Vigil&) = delete;

  /// Feeds both once a second, unless the acquisition has been silent for too long.
  void step(Nanoseconds silence, HostTime now) {
    if (now < next_ || silence > limit_) return;
    next_ = now + Nanoseconds{1'000'000'000};
    notice_.tell("WATCHDOG=1");
    if (hardware_ != nullptr) hardware_->feed();
  }

 private:
  ServiceNotice notice_;
  Watchdog* hardware_;
  Nanoseconds limit_;
  HostTime next_{};
};

}  // namespace enamel::fw
