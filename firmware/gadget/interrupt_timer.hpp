// A limit for system calls that know none: a signal that breaks them off.
#pragma once

#include <chrono>
#include <ctime>

namespace enamel::fw {

/// Sends SIGALRM to the process after the limit and every 100 ms from then on, so that a call that begins just after a
/// signal is broken off too; the call fails with EINTR. For programs of one thread; one object at a time.
class InterruptTimer {
 public:
  InterruptTimer();
  ~InterruptTimer();
  InterruptTimer(const InterruptTimer&) = delete;
  InterruptTimer& operator=(const InterruptTimer&) = delete;

  void arm(std::chrono::milliseconds limit) noexcept { set(limit); }
  void disarm() noexcept { set(std::chrono::milliseconds(0)); }

 private:
  void set(std::chrono::milliseconds first) noexcept;
  timer_t timer_{};
  bool usable_ = false;
};

}  // namespace enamel::fw
