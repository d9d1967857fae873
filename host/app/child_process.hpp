// A child process that never outlives its parent. Used by `enamel demo` to run the probe and the twin as processes of
// their own, and by the end-to-end tests.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct ChildOptions {
  std::string stdout_path;  ///< empty: inherited
  std::string stderr_path;  ///< empty: inherited
};

/// Movable owner; the destructor ends the child (SIGTERM, then SIGKILL after one second).
class ChildProcess {
 public:
  /// Errors: kFileNotFound when the program cannot be started.
  [[nodiscard]] static Result<ChildProcess> start(const std::vector<std::string>& argv,
                                                  const ChildOptions& options = {});

  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();

  /// Exit code, or 128 + signal; nullopt while it runs.
  [[nodiscard]] std::optional<int> poll();
  /// Waits at most `timeout`.
  [[nodiscard]] std::optional<int> wait(Clock& clock, Nanoseconds timeout);
  void signal(int number) const;
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }

 private:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}
  void end() noexcept;

  pid_t pid_ = -1;
  std::optional<int> code_;
};

/// Path of a program that was built beside this one ("enamel-probe").
[[nodiscard]] std::string sibling_program(const std::string& name);

}  // namespace enamel::app
