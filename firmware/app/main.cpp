// enamel-probe: the acquisition process of the probe.
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <iostream>
#include <string_view>

#include "firmware/app/camera_command.hpp"
#include "firmware/app/check_command.hpp"
#include "firmware/app/options.hpp"
#include "firmware/app/probe.hpp"
#include "firmware/app/projector_command.hpp"
#include "firmware/app/self_test_client.hpp"
#include "protocol/base/stdout_check.hpp"

namespace {

std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free);

// A link or a renderer that does not let go must not hold the program: the light is off long before.
void give_up(int) { _exit(0); }

void request_stop(int) {
  g_stop.store(true, std::memory_order_release);
  const itimerval limit{{0, 0}, {0, 900'000}};
  setitimer(ITIMER_REAL, &limit, nullptr);
}

void handle_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_handler = give_up;
  sigaction(SIGALRM, &action, nullptr);
}

enamel::Result<int> run(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "projector") {
    handle_signals();
    return enamel::fw::run_projector(argc - 1, argv + 1, g_stop);
  }
  ENAMEL_TRY_ASSIGN(const auto options, enamel::fw::parse_options(argc, argv));
  if (!options) return 0;
  handle_signals();
  if (options->self_test) return enamel::fw::ask_self_test(*options, g_stop);
  if (options->camera == "list") return enamel::fw::print_cameras(options->json);
  if (options->check) return enamel::fw::run_check(*options, g_stop);
  if (options->dark) return enamel::fw::run_dark(*options);
  return enamel::fw::run_probe(*options, g_stop);
}

int report(const enamel::Error& error) {
  std::cerr << "enamel-probe: " << error.message() << '\n';
  return enamel::exit_code(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto code = run(argc, argv);
    return code ? enamel::with_stdout_written(*code) : report(code.error());
  } catch (const std::exception& e) {
    return report({enamel::ErrorCode::kInternal, e.what()});
  }
}
