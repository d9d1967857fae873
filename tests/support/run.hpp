// Runs a program of the build to its end and returns what it printed. For end-to-end tests.
#pragma once

#include <unistd.h>

#include <chrono>
#include <string>
#include <vector>

#include "host/app/child_process.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel::test {

struct Ran {
  int code = -1;  ///< exit code, 128 + signal, or -1 when it had to be killed
  std::string out, err;
};

inline std::string program(const std::string& name) { return std::string(ENAMEL_BIN_DIR) + "/" + name; }

/// A DDS tag that no other test or session uses.
inline std::string unique_tag() {
  static int count = 0;
  return "enamel-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
}

inline Ran run(const std::vector<std::string>& argv, std::chrono::seconds timeout = std::chrono::seconds(60)) {
  const TempFolder folder;
  Ran ran;
  auto child = app::ChildProcess::start(argv, {folder / "out", folder / "err"});
  if (!child) {
    ran.err = child.error().message();
    return ran;
  }
  SteadyClock clock;
  ran.code = child->wait(clock, timeout).value_or(-1);
  ran.out = read_file(folder / "out").value_or("");
  ran.err = read_file(folder / "err").value_or("");
  return ran;
}

inline Ran shell(const std::string& command, std::chrono::seconds timeout = std::chrono::seconds(120)) {
  return run({"/bin/sh", "-c", command}, timeout);
}

}  // namespace enamel::test
