// Preloaded into enamel-probe in the guest: SIMULATION of /dev/i2c-1 and /dev/gpiochip0, whose drivers that kernel has
// not. Whether a node of that name may be opened, and everything else, the kernel decides.
#include <dlfcn.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstring>
#include <set>

#include "tests/guest/probe/board_protocol.hpp"

namespace {

using namespace enamel::guest;

constexpr const char* kBusNode = "/dev/i2c-1";
constexpr const char* kChipNode = "/dev/gpiochip0";
std::set<int> g_buses, g_chips, g_outputs;  // opened before the probe has threads

int connect_to_board(const Hello& hello) {
  const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, kBoardSocket, sizeof address.sun_path - 1);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::send(fd, &hello, sizeof hello, 0) != static_cast<ssize_t>(sizeof hello)) {
    ::close(fd);
    return -1;
  }
  return fd;
}

bool exchange(int fd, Packet& packet) {
  return ::send(fd, &packet, sizeof packet, 0) == static_cast<ssize_t>(sizeof packet) &&
         ::recv(fd, &packet, sizeof packet, 0) == static_cast<ssize_t>(sizeof packet);
}

int bus(int fd, unsigned long request, void* argument) {
  if (request == I2C_FUNCS) {
    *static_cast<unsigned long*>(argument) = I2C_FUNC_I2C;
    return 0;
  }
  if (request != I2C_RDWR) return 0;
  const auto* data = static_cast<const i2c_rdwr_ioctl_data*>(argument);
  for (std::uint32_t i = 0; i < data->nmsgs; ++i) {
    const i2c_msg& message = data->msgs[i];
    Packet packet;
    packet.is_read = (message.flags & I2C_M_RD) != 0 ? 1 : 0;
    packet.length = message.len;
    if (packet.is_read == 0) std::memcpy(packet.data.data(), message.buf, message.len);
    if (!exchange(fd, packet) || packet.refused != 0) return errno = EREMOTEIO, -1;
    if (packet.is_read != 0) std::memcpy(message.buf, packet.data.data(), message.len);
  }
  return static_cast<int>(data->nmsgs);
}

int chip(unsigned long request, void* argument) {
  if (request != GPIO_V2_GET_LINE_IOCTL) return errno = EINVAL, -1;
  auto* lines = static_cast<gpio_v2_line_request*>(argument);
  const bool output = (lines->config.flags & GPIO_V2_LINE_FLAG_OUTPUT) != 0;
  const int fd = connect_to_board({output ? Channel::kOutput : Channel::kEvents, lines->offsets[0]});
  if (fd < 0) return -1;
  if (output) g_outputs.insert(fd);
  lines->fd = fd;
  return 0;
}

int output(int fd, unsigned long request, void* argument) {
  if (request != GPIO_V2_LINE_SET_VALUES_IOCTL) return errno = EINVAL, -1;
  Packet packet;
  packet.length = 1;
  packet.data[0] = (static_cast<const gpio_v2_line_values*>(argument)->bits & 1U) != 0 ? 1 : 0;
  // The handle was made non-blocking; an answer is waited for all the same.
  const int flags = ::fcntl(fd, F_GETFL);
  ::fcntl(fd, F_SETFL, flags & ~O_NONBLOCK);
  const bool done = exchange(fd, packet);
  ::fcntl(fd, F_SETFL, flags);
  return done ? 0 : (errno = EIO, -1);
}

/// A node that is missing, or has no driver behind it, is as good as opened; one that a sandbox denies is not.
int simulate_node(const char* path, int opened) {
  if (opened < 0 && (errno == EPERM || errno == EACCES)) return -1;
  if (opened >= 0) ::close(opened);
  const bool is_bus = std::strcmp(path, kBusNode) == 0;
  // A chip's is a number that nothing else has.
  const int fd = is_bus ? connect_to_board({Channel::kBus, 0}) : ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
  if (fd >= 0) (is_bus ? g_buses : g_chips).insert(fd);
  return fd;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  using Open = int (*)(const char*, int, ...);
  static const auto next = reinterpret_cast<Open>(::dlsym(RTLD_NEXT, "open"));
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  const int fd = next(path, flags, mode);
  const bool simulated = std::strcmp(path, kBusNode) == 0 || std::strcmp(path, kChipNode) == 0;
  return simulated ? simulate_node(path, fd) : fd;
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  if (g_buses.contains(fd)) return bus(fd, request, argument);
  if (g_chips.contains(fd)) return chip(request, argument);
  if (g_outputs.contains(fd)) return output(fd, request, argument);
  using Ioctl = int (*)(int, unsigned long, ...);
  static const auto next = reinterpret_cast<Ioctl>(::dlsym(RTLD_NEXT, "ioctl"));
  return next(fd, request, argument);
}

}  // extern "C"
