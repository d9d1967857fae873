#include "firmware/device/linux/lines/kernel_watchdog.hpp"

#include <fcntl.h>
#include <linux/watchdog.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

constexpr char kDisarm = 'V';  // the kernel's "magic close"

const char* remedy(int error) {
  switch (error) {
    case ENOENT:
      return "; there is none: load the board's watchdog driver, or leave watchdog.device empty";
    case EPERM:
      return ": denied by the service's sandbox: its unit needs DeviceAllow for it";
    case EACCES:
      return ": add the user to the group that owns it, or run as root";
    case EBUSY:
      return "; another program feeds it: with RuntimeWatchdogSec systemd does, leave watchdog.device empty then";
    default:
      return "";
  }
}

}  // namespace

Result<std::unique_ptr<KernelWatchdog>> KernelWatchdog::open(const std::string& path, int seconds) {
  LineHandle fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (fd.fd() < 0) {
    return fail(ErrorCode::kBoardLine, "watchdog " + path + ": " + std::strerror(errno) + remedy(errno));
  }
  if (::ioctl(fd.fd(), WDIOC_SETTIMEOUT, &seconds) != 0) {
    static_cast<void>(::write(fd.fd(), &kDisarm, 1));
    return fail(ErrorCode::kBoardLine,
                "watchdog " + path + " takes no limit of " + std::to_string(seconds) + " s: " + std::strerror(errno));
  }
  return std::make_unique<KernelWatchdog>(std::move(fd));
}

KernelWatchdog::~KernelWatchdog() {
  if (::write(fd_.fd(), &kDisarm, 1) != 1) log::warn("watchdog", "cannot be disarmed: it will reset the board");
}

void KernelWatchdog::feed() noexcept {
  const char fed = 1;
  if (::write(fd_.fd(), &fed, 1) != 1) log::error("watchdog", "cannot be fed: {}", std::strerror(errno));
}

}  // namespace enamel::fw
