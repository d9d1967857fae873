#include "firmware/device/linux/dlpc350/message.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace enamel::fw::dlpc350 {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kReadFlag = 0x80, kReplyFlag = 0x40, kNackFlag = 0x20;
constexpr std::size_t kHeader = 4, kReport = std::tuple_size_v<HidReport>;
constexpr std::size_t kMostAnswer = 512;  // a whole pattern table has 384 bytes
constexpr int kMostLate = 16;
constexpr Nanoseconds kAnswer{500'000'000};

tl::unexpected<Error> failed(const Command& c, const std::string& why) {
  return fail(ErrorCode::kProjector, fmt::format("projector: {} ({:02X}.{:02X}): {}", c.name, c.cmd2, c.cmd3, why));
}

}  // namespace

std::vector<HidReport> reports_of(const Command& command, Direction direction, std::uint8_t sequence,
                                  std::span<const std::uint8_t> payload) {
  const std::size_t length = 2 + payload.size();
  const unsigned read = direction == Direction::kRead ? kReadFlag : 0U;
  Bytes message{static_cast<std::uint8_t>(read | kReplyFlag), sequence,     static_cast<std::uint8_t>(length & 0xFFU),
                static_cast<std::uint8_t>(length >> 8U),      command.cmd3, command.cmd2};
  message.insert(message.end(), payload.begin(), payload.end());
  std::vector<HidReport> reports;
  for (std::size_t at = 0; at < message.size(); at += kReport) {
    const auto piece = std::span(message).subspan(at, std::min(kReport, message.size() - at));
    std::copy(piece.begin(), piece.end(), reports.emplace_back(HidReport{}).begin());
  }
  return reports;
}

Result<void> Channel::write(const Command& command, std::span<const std::uint8_t> payload) {
  ENAMEL_TRY(exchange(command, Direction::kWrite, payload));
  return {};
}

Result<Bytes> Channel::read(const Command& command, std::size_t size) {
  ENAMEL_TRY_ASSIGN(Bytes data, exchange(command, Direction::kRead, {}));
  if (data.size() >= size) return data;
  return failed(command,
                fmt::format("{} bytes for an answer, not {}: its software is of another version", data.size(), size));
}

Result<Bytes> Channel::exchange(const Command& command, Direction direction, std::span<const std::uint8_t> payload) {
  ENAMEL_TRY(forget_late_answers());
  ++sequence_;
  for (const HidReport& report : reports_of(command, direction, sequence_, payload)) ENAMEL_TRY(port_->write(report));
  return answer(command);
}

/// An answer that came after its deadline must not pass for the next one's.
Result<void> Channel::forget_late_answers() {
  HidReport report{};
  for (int i = 0; i < kMostLate; ++i) {
    ENAMEL_TRY_ASSIGN(const std::size_t n, port_->read(report, Nanoseconds{0}));
    if (n == 0) break;
  }
  return {};
}

Result<Bytes> Channel::answer(const Command& command) {
  HidReport report{};
  ENAMEL_TRY_ASSIGN(std::size_t n, port_->read(report, kAnswer));
  if (n == 0) return failed(command, "no answer within 0.5 s: switch the projector off and on");
  if (n < kHeader) return failed(command, fmt::format("an answer of {} bytes: check the USB cable", n));
  if (report[1] != sequence_) {
    return failed(command, fmt::format("answer {} to message {}: does another program talk to the projector?",
                                       report[1], sequence_));
  }
  if ((report[0] & kNackFlag) != 0) return failed(command, "refused (NACK): its software may be of another version");
  const std::size_t length = report[2] | (std::size_t{report[3]} << 8U);
  if (length > kMostAnswer) return failed(command, fmt::format("an answer of {} bytes: check the USB cable", length));
  Bytes data(report.begin() + kHeader, report.begin() + static_cast<std::ptrdiff_t>(n));
  while (data.size() < length) {
    const bool was_whole = n == kReport;
    if (was_whole) {
      ENAMEL_TRY_ASSIGN(n, port_->read(report, kAnswer));
    }
    if (!was_whole || n == 0) {
      return failed(command,
                    fmt::format("its answer ends after {} of {} bytes: check the USB cable", data.size(), length));
    }
    data.insert(data.end(), report.begin(), report.begin() + static_cast<std::ptrdiff_t>(n));
  }
  data.resize(length);
  return data;
}

}  // namespace enamel::fw::dlpc350
