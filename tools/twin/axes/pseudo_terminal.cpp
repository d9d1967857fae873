#include "tools/twin/axes/pseudo_terminal.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

namespace enamel::twin {
namespace {

namespace fs = std::filesystem;

void make_raw(const std::string& port) {
  const int program = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (program < 0) return;
  termios t{};
  ::tcgetattr(program, &t);
  ::cfmakeraw(&t);
  ::tcsetattr(program, TCSANOW, &t);
  ::close(program);  // from here on the controller sees a hang-up until somebody opens the port
}

}  // namespace

Result<PseudoTerminal> PseudoTerminal::open() {
  PseudoTerminal terminal;
  terminal.controller_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const int end = terminal.controller_;
  if (end < 0 || ::grantpt(end) != 0 || ::unlockpt(end) != 0) {
    return fail(ErrorCode::kHal, std::string("no pseudo-terminal for the simulated axes: ") + std::strerror(errno) +
                                     "; end programs that hold some, or mount devpts");
  }
  terminal.port_ = ::ptsname(end);
  make_raw(terminal.port_);
  return terminal;
}

PseudoTerminal::PseudoTerminal(PseudoTerminal&& other) noexcept
    : controller_(std::exchange(other.controller_, -1)), port_(std::move(other.port_)) {}

void PseudoTerminal::close() noexcept {
  if (controller_ >= 0) ::close(std::exchange(controller_, -1));
}

Result<PortName> PortName::create(const std::string& name, const std::string& port) {
  std::error_code ec;
  const fs::file_status there = fs::symlink_status(name, ec);
  if (fs::exists(there) && !fs::is_symlink(there)) {
    return fail(ErrorCode::kFileWrite, name + " is there and no link of an earlier run: choose another name");
  }
  fs::remove(name, ec);
  fs::create_symlink(port, name, ec);
  if (ec) return fail(ErrorCode::kFileWrite, name + ": " + ec.message() + "; choose a name in a folder of yours");
  return PortName(name, port);
}

PortName::PortName(PortName&& other) noexcept
    : name_(std::exchange(other.name_, {})), port_(std::exchange(other.port_, {})) {}

PortName::~PortName() {
  if (name_.empty()) return;
  // Another program may have taken the name over meanwhile.
  std::error_code ec;
  if (fs::read_symlink(name_, ec) == port_) fs::remove(name_, ec);
}

}  // namespace enamel::twin
