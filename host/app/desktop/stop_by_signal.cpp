#include "host/app/desktop/stop_by_signal.hpp"

#include <array>
#include <atomic>
#include <csignal>

namespace enamel::app {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

std::atomic<motion::Axes*> g_axes{nullptr};

void on_stop_signal(int) {
  if (motion::Axes* axes = g_axes.load()) axes->request_stop();
}

}  // namespace

StopBySignal::StopBySignal(motion::Axes& axes) {
  g_axes = &axes;
  for (const int number : kSignals) std::signal(number, on_stop_signal);
}

StopBySignal::~StopBySignal() {
  for (const int number : kSignals) std::signal(number, SIG_DFL);
  g_axes = nullptr;
}

}  // namespace enamel::app
