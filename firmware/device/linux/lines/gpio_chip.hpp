// Lines of a GPIO chip by the kernel's character device, uAPI v2. The ioctls themselves: libgpiod 1 hides the sequence
// numbers by which lost events are noticed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// A file descriptor that closes itself.
class LineHandle {
 public:
  LineHandle() = default;
  explicit LineHandle(int fd) noexcept : fd_(fd) {}
  LineHandle(LineHandle&& other) noexcept;
  LineHandle& operator=(LineHandle&& other) noexcept;
  LineHandle(const LineHandle&) = delete;
  LineHandle& operator=(const LineHandle&) = delete;
  ~LineHandle();
  [[nodiscard]] int fd() const noexcept { return fd_; }

 private:
  int fd_ = -1;
};

enum class LineUse : std::uint8_t {
  kEvents,  ///< input; rising and falling edges are queued with their time
  kOutput,  ///< driven low until told otherwise
};

/// Errors: kBoardLine with the remedy: no such chip, no such line, line taken (and by whom), no permission.
[[nodiscard]] Result<LineHandle> request_lines(const std::string& chip, std::span<const std::uint32_t> offsets,
                                               LineUse use);

/// The only line of an output handle. False when the kernel refuses.
[[nodiscard]] bool set_line(const LineHandle& output, bool high) noexcept;

}  // namespace enamel::fw
