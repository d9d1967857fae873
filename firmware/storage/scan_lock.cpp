#include "firmware/storage/scan_lock.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace enamel::fw {
namespace {

constexpr mode_t kForBothProcesses = 0660;
constexpr int kTakeTries = 5, kTryEveryMs = 1;

}  // namespace

Result<std::unique_ptr<ScanLock>> ScanLock::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kForBothProcesses);
  if (fd < 0) return fail(ErrorCode::kFileWrite, "scan lock " + path + ": " + std::strerror(errno));
  return std::unique_ptr<ScanLock>(new ScanLock(fd));
}

ScanLock::~ScanLock() { ::close(fd_); }

bool ScanLock::take() noexcept {
  // held_elsewhere() of the other process has it for microseconds.
  for (int tries = 0; !held_ && tries < kTakeTries; ++tries) {
    if (tries > 0) static_cast<void>(::poll(nullptr, 0, kTryEveryMs));
    held_ = ::flock(fd_, LOCK_EX | LOCK_NB) == 0;
  }
  return held_;
}

void ScanLock::release() noexcept {
  if (held_) static_cast<void>(::flock(fd_, LOCK_UN));
  held_ = false;
}

bool ScanLock::held_elsewhere() const noexcept {
  if (held_) return false;
  if (::flock(fd_, LOCK_SH | LOCK_NB) != 0) return errno == EWOULDBLOCK;
  static_cast<void>(::flock(fd_, LOCK_UN));
  return false;
}

}  // namespace enamel::fw
