#include "host/motion/serial_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace enamel::motion {
namespace {

std::string open_advice(int error) {
  if (error == ENOENT || error == ENODEV || error == ENXIO) {
    return "no such port: plug the controller in; `ls /dev/ttyUSB* /dev/ttyACM*` shows what there is";
  }
  if (error == EACCES || error == EPERM) return "no permission: add the user to group dialout and log in again";
  if (error == EBUSY) return "another program holds it: end that one";
  return std::strerror(error);
}

Result<void> set_up(int fd, const std::string& path) {
  termios t{};
  if (::tcgetattr(fd, &t) != 0) return fail(ErrorCode::kAxes, path + ": is no serial port: give the controller's");
  ::cfmakeraw(&t);
  t.c_cflag |= static_cast<tcflag_t>(CLOCAL | CREAD);
  // DTR stays up when the port closes, so that opening it again does not reset an Arduino in the middle of a move.
  t.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CSTOPB | CRTSCTS);
  t.c_cc[VMIN] = 0;
  t.c_cc[VTIME] = 0;
  ::cfsetispeed(&t, B115200);
  ::cfsetospeed(&t, B115200);
  if (::tcsetattr(fd, TCSANOW, &t) != 0) {
    return fail(ErrorCode::kAxes, fmt::format("{}: takes no 115200 baud: {}", path, std::strerror(errno)));
  }
  ::tcflush(fd, TCIOFLUSH);
  return {};
}

bool is_line_end(char c) { return c == '\n' || c == '\r'; }

}  // namespace

Result<SerialPort> SerialPort::open(const std::string& path, Clock& clock) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return fail(ErrorCode::kAxes, path + ": " + open_advice(errno));
  SerialPort port(fd, path, clock);
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) return fail(ErrorCode::kAxes, path + ": " + open_advice(EBUSY));
  ENAMEL_TRY(set_up(fd, path));
  // Programs that do not look at the lock are kept out by this one.
  static_cast<void>(::ioctl(fd, TIOCEXCL));
  return port;
}

SerialPort::SerialPort(SerialPort&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      path_(std::move(other.path_)),
      clock_(other.clock_),
      pending_(std::move(other.pending_)),
      is_lost_(other.is_lost_) {}

SerialPort::~SerialPort() {
  if (fd_ < 0) return;
  static_cast<void>(::ioctl(fd_, TIOCNXCL));
  // What could not be sent is dropped: waiting for it in close() would hang on a dead line.
  ::tcflush(fd_, TCOFLUSH);
  ::close(fd_);
}

tl::unexpected<Error> SerialPort::lost(std::string_view doing) {
  is_lost_ = true;
  return fail(ErrorCode::kAxes, fmt::format("{}: the line is gone while {}: cable pulled or controller switched off; "
                                            "connect it, start again and home",
                                            path_, doing));
}

Result<bool> SerialPort::wait_for(short events, HostTime until) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - clock_.now()).count();
    pollfd p{fd_, events, 0};
    const int ready = ::poll(&p, 1, static_cast<int>(std::clamp<std::int64_t>(left, 0, 60'000)));
    if (ready < 0 && errno == EINTR) {
      // A signal asks the program to stop: whoever waits looks at that between two waits.
      return false;
    }
    if (ready < 0) return lost("waiting");
    if (ready > 0 && (p.revents & events) != 0) return true;
    if (ready > 0) return lost(events == POLLIN ? "reading" : "writing");
    if (clock_.now() >= until) return false;
  }
}

Result<void> SerialPort::write(std::string_view bytes, HostTime deadline) {
  if (is_lost_) return lost("writing");
  while (!bytes.empty()) {
    const ssize_t n = ::write(fd_, bytes.data(), bytes.size());
    if (n > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
      continue;
    }
    if (n < 0 && errno != EAGAIN && errno != EINTR) return lost("writing");
    if (clock_.now() >= deadline) {
      return fail(ErrorCode::kAxes, path_ +
                                        ": takes no more bytes: the controller hangs, or flow control is on; switch "
                                        "it off and on, then home");
    }
    ENAMEL_TRY(wait_for(POLLOUT, deadline));
  }
  return {};
}

std::optional<std::string> SerialPort::take_line() {
  const auto first = std::find_if_not(pending_.begin(), pending_.end(), is_line_end);
  pending_.erase(pending_.begin(), first);
  const auto end = std::find_if(pending_.begin(), pending_.end(), is_line_end);
  const bool is_overlong = pending_.size() > kLongestLine;
  if (end == pending_.end() && !is_overlong) return std::nullopt;
  const auto stop = std::min(end, pending_.begin() + std::min<std::ptrdiff_t>(std::ssize(pending_), kLongestLine));
  std::string line(pending_.begin(), stop);
  pending_.erase(pending_.begin(), stop);
  return line;
}

Result<std::optional<std::string>> SerialPort::read_line(HostTime until) {
  for (;;) {
    if (auto line = take_line()) return line;
    if (is_lost_) return lost("reading");
    ENAMEL_TRY_ASSIGN(const bool is_ready, wait_for(POLLIN, until));
    if (!is_ready) return std::optional<std::string>{};
    char buffer[512];
    const ssize_t n = ::read(fd_, buffer, sizeof(buffer));
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) return lost("reading");
    if (n > 0) pending_.append(buffer, static_cast<std::size_t>(n));
  }
}

}  // namespace enamel::motion
