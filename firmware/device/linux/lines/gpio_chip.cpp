#include "firmware/device/linux/lines/gpio_chip.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace enamel::fw {
namespace {

constexpr const char* kConsumer = "enamel-probe";
constexpr std::uint32_t kBuffered = 1024;  // events: half a second of five edges a frame

std::string who_has(int chip, std::uint32_t offset) {
  gpio_v2_line_info info{};
  info.offset = offset;
  if (::ioctl(chip, GPIO_V2_GET_LINEINFO_IOCTL, &info) != 0) return "line " + std::to_string(offset) + " is not there";
  if ((info.flags & GPIO_V2_LINE_FLAG_USED) == 0) return "";
  return "line " + std::to_string(offset) + " is in use by '" + info.consumer + "'";
}

std::string remedy(int chip, std::span<const std::uint32_t> offsets, int error) {
  if (error == EPERM) return "denied by the service's sandbox: its unit needs DeviceAllow for it";
  if (error == EACCES) return "no permission: add the user to the group gpio, or run as root";
  for (const std::uint32_t offset : offsets) {
    if (const std::string who = who_has(chip, offset); !who.empty()) return who;
  }
  return std::strerror(error);
}

}  // namespace

LineHandle::LineHandle(LineHandle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
LineHandle& LineHandle::operator=(LineHandle&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}
LineHandle::~LineHandle() {
  if (fd_ >= 0) ::close(fd_);
}

Result<LineHandle> request_lines(const std::string& chip, std::span<const std::uint32_t> offsets, LineUse use) {
  const LineHandle opened(::open(chip.c_str(), O_RDWR | O_CLOEXEC));
  if (opened.fd() < 0) {
    const std::string why = errno == ENOENT ? "no such GPIO chip; `gpiodetect` lists them" : remedy(-1, {}, errno);
    return fail(ErrorCode::kBoardLine, "lines of " + chip + ": " + why);
  }
  gpio_v2_line_request request{};
  if (offsets.empty() || offsets.size() > GPIO_V2_LINES_MAX) return fail(ErrorCode::kInternal, "number of GPIO lines");
  for (std::size_t i = 0; i < offsets.size(); ++i) request.offsets[i] = offsets[i];
  std::strncpy(request.consumer, kConsumer, sizeof request.consumer - 1);
  request.num_lines = static_cast<std::uint32_t>(offsets.size());
  request.event_buffer_size = use == LineUse::kEvents ? kBuffered : 0;
  request.config.flags = use == LineUse::kEvents
                             ? GPIO_V2_LINE_FLAG_INPUT | GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING
                             : GPIO_V2_LINE_FLAG_OUTPUT;
  if (::ioctl(opened.fd(), GPIO_V2_GET_LINE_IOCTL, &request) != 0) {
    return fail(ErrorCode::kBoardLine, "lines of " + chip + ": " + remedy(opened.fd(), offsets, errno));
  }
  LineHandle lines(request.fd);
  if (::fcntl(lines.fd(), F_SETFL, O_NONBLOCK) != 0)
    return fail(ErrorCode::kBoardLine, "lines of " + chip + ": no reading");
  return lines;
}

bool set_line(const LineHandle& output, bool high) noexcept {
  gpio_v2_line_values values{};
  values.mask = 1;
  values.bits = high ? 1 : 0;
  return ::ioctl(output.fd(), GPIO_V2_LINE_SET_VALUES_IOCTL, &values) == 0;
}

}  // namespace enamel::fw
