// enamel-updated: the update process of the probe.
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <exception>

#include "firmware/updater/updater.hpp"
#include "protocol/base/stdout_check.hpp"

namespace {

std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void request_stop(int) { g_stop.store(true, std::memory_order_release); }

/// Without SA_RESTART: a call that waits ends.
void handle_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int report(const enamel::Error& error) {
  std::fprintf(stderr, "enamel-updated: %s\n", error.message().c_str());
  return enamel::exit_code(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto options = enamel::fw::parse_updater_options(argc, argv);
    if (!options) return report(options.error());
    if (!*options) return enamel::with_stdout_written(0);
    handle_signals();
    const auto code = enamel::fw::run_updater(**options, g_stop);
    return code ? *code : report(code.error());
  } catch (const std::exception& e) {
    return report({enamel::ErrorCode::kInternal, e.what()});
  }
}
