// A serial line that never blocks longer than it is told.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::motion {

/// 115200 baud, 8 bits, no parity, one stop bit, no flow control; exclusively ours while open. One thread at a time.
class SerialPort {
 public:
  static constexpr std::size_t kLongestLine = 256;

  /// kAxes: no such port, no permission, held by another program, no serial port at all; each with its remedy.
  [[nodiscard]] static Result<SerialPort> open(const std::string& path, Clock& clock);
  SerialPort(SerialPort&& other) noexcept;
  SerialPort& operator=(SerialPort&&) = delete;
  ~SerialPort();

  /// kAxes when the line is gone, or does not take the bytes until the deadline.
  [[nodiscard]] Result<void> write(std::string_view bytes, HostTime deadline);
  /// The next line without its end; empty lines are left out; nothing when none came until then or a signal did.
  /// Bytes beyond
  /// kLongestLine without a line end come as a line. kAxes when the line is gone.
  [[nodiscard]] Result<std::optional<std::string>> read_line(HostTime until);
  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  SerialPort(int fd, std::string path, Clock& clock) : fd_(fd), path_(std::move(path)), clock_(clock) {}
  [[nodiscard]] Result<bool> wait_for(short events, HostTime until);
  [[nodiscard]] std::optional<std::string> take_line();
  [[nodiscard]] tl::unexpected<Error> lost(std::string_view doing);

  int fd_;
  std::string path_;
  Clock& clock_;
  std::string pending_;
  bool is_lost_ = false;
};

}  // namespace enamel::motion
