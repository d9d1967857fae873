#include "tests/unit/viewer/xvfb.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace enamel::view::test {

Xvfb::Xvfb() {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) {
    problem_ = "no pipe";
    return;
  }
  pid_ = fork();
  if (pid_ == 0) {
    const std::string fd = std::to_string(ends[1]);
    close(ends[0]);
    const int nowhere = open("/dev/null", O_RDWR);
    dup2(nowhere, STDIN_FILENO);
    dup2(nowhere, STDERR_FILENO);
    execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1400x900x24", "-nolisten", "tcp", "-noreset",
           nullptr);
    _exit(127);
  }
  close(ends[1]);
  std::string number;
  std::array<char, 16> part{};
  pollfd wait{ends[0], POLLIN, 0};
  while (number.find('\n') == std::string::npos && poll(&wait, 1, 20000) > 0) {
    const ssize_t got = read(ends[0], part.data(), part.size());
    if (got <= 0) {
      break;
    }
    number.append(part.data(), static_cast<std::size_t>(got));
  }
  close(ends[0]);
  if (number.empty() || number.back() != '\n') {
    problem_ = "Xvfb is missing or did not start (package xvfb)";
    return;
  }
  number.pop_back();
  setenv("DISPLAY", (":" + number).c_str(), 1);
}

Xvfb::~Xvfb() {
  if (pid_ > 0) {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
}

}  // namespace enamel::view::test
