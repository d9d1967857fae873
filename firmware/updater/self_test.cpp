#include "firmware/updater/self_test.hpp"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace enamel::fw {
namespace {

constexpr std::chrono::milliseconds kLookEvery{20};
constexpr int kCannotRun = 127;

/// In a process group of its own, so that its children end with it.
[[noreturn]] void become(const char* command, const char* slot) noexcept {
  setpgid(0, 0);
  setenv("ENAMEL_SLOT", slot, 1);
  execl("/bin/sh", "sh", "-c", command, static_cast<char*>(nullptr));
  _exit(kCannotRun);
}

}  // namespace

bool run_self_test(const std::string& command, const std::string& slot, Clock& clock,
                   std::chrono::milliseconds limit) noexcept {
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) become(command.c_str(), slot.c_str());
  const HostTime deadline = clock.now() + limit;
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (ended < 0 && errno != EINTR) return false;
    if (clock.now() >= deadline) break;
    clock.sleep_for(kLookEvery);
  }
  kill(-child, SIGKILL);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return false;
}

}  // namespace enamel::fw
