#include "host/app/desktop/stop_by_signal.hpp"

#include <array>
#include <atomic>
#include <csignal>

namespace enamel::app {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

std::atomic<void*> g_what{nullptr};
std::atomic<void (*)(void*)> g_request_stop{nullptr};

void on_stop_signal(int) {
  if (void* what = g_what.load()) g_request_stop.load()(what);
}

}  // namespace

StopBySignal::StopBySignal(void* what, void (*request_stop)(void*)) {
  g_request_stop = request_stop;
  g_what = what;
  for (const int number : kSignals) std::signal(number, on_stop_signal);
}

StopBySignal::~StopBySignal() {
  for (const int number : kSignals) std::signal(number, SIG_DFL);
  g_what = nullptr;
}

}  // namespace enamel::app
