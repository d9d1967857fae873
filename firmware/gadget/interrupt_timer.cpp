#include "firmware/gadget/interrupt_timer.hpp"

#include <csignal>

namespace enamel::fw {
namespace {

constexpr long kAgainNs = 100'000'000;

void only_interrupt(int) {}

}  // namespace

InterruptTimer::InterruptTimer() {
  struct sigaction action {};
  action.sa_handler = only_interrupt;  // without SA_RESTART: the call ends
  sigaction(SIGALRM, &action, nullptr);
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  usable_ = timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
}

InterruptTimer::~InterruptTimer() {
  if (usable_) timer_delete(timer_);
}

void InterruptTimer::set(std::chrono::milliseconds first) noexcept {
  if (!usable_) return;
  itimerspec when{};
  when.it_value.tv_sec = first.count() / 1000;
  when.it_value.tv_nsec = first.count() % 1000 * 1'000'000;
  if (first.count() > 0) when.it_interval.tv_nsec = kAgainNs;
  timer_settime(timer_, 0, &when, nullptr);
}

}  // namespace enamel::fw
