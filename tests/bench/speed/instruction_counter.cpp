#include "tests/bench/speed/instruction_counter.hpp"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace enamel::bench {

InstructionCounter::~InstructionCounter() {
  if (fd_ >= 0) close(fd_);
}

bool InstructionCounter::open() noexcept {
  perf_event_attr attr{};
  attr.size = sizeof attr;
  attr.type = PERF_TYPE_HARDWARE;
  attr.config = PERF_COUNT_HW_INSTRUCTIONS;
  attr.exclude_kernel = 1;  // and because perf_event_paranoid = 2 allows no more to users
  attr.exclude_hv = 1;
  attr.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  fd_ = static_cast<int>(syscall(SYS_perf_event_open, &attr, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
  errno_ = fd_ < 0 ? errno : 0;
  return fd_ >= 0;
}

std::uint64_t InstructionCounter::value() noexcept {
  std::array<std::uint64_t, 3> read_out{};  // count, ns enabled, ns running
  if (fd_ < 0 || read(fd_, read_out.data(), sizeof read_out) != sizeof read_out) return 0;
  shared_ = shared_ || read_out[2] < read_out[1];
  return read_out[0];
}

std::string InstructionCounter::problem() const {
  if (fd_ >= 0) return shared_ ? "the counter was shared with another user: instructions are too low" : "";
  const std::string why = std::strerror(errno_);
  if (errno_ == EACCES || errno_ == EPERM) {
    return "no instruction counter (" + why +
           "): needs kernel.perf_event_paranoid <= 2 and perf_event_open in containers";
  }
  return "no instruction counter (" + why + "): this machine or guest shows none to the kernel";
}

}  // namespace enamel::bench
