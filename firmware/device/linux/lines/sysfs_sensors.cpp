#include "firmware/device/linux/lines/sysfs_sensors.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <charconv>

#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

constexpr long kLowest = 0, kHighest = 80'000;  // milli-degrees: beyond, a thermistor is open or shorted
constexpr long kColdest = -40'000, kHottest = 125'000;
constexpr int kUnknownMa = 1;

/// No allocation: the light asks from a safety path.
std::optional<long> number_in(const std::string& path) noexcept {
  if (path.empty()) return std::nullopt;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  std::array<char, 32> text{};
  const ssize_t n = ::read(fd, text.data(), text.size());
  ::close(fd);
  long value = 0;
  if (n <= 0 || std::from_chars(text.data(), text.data() + n, value).ec != std::errc{}) return std::nullopt;
  return value;
}

std::optional<std::int16_t> centi(const std::string& path, long low, long high) {
  const auto milli = number_in(path);
  if (!milli || *milli < low || *milli > high) return std::nullopt;
  return static_cast<std::int16_t>(*milli / 10);
}

}  // namespace

Temperatures SysfsThermal::read() const {
  return {centi(files_.tip, kLowest, kHighest), centi(files_.led, kColdest, kHottest),
          centi(files_.soc, kColdest, kHottest), centi(files_.optics, kLowest, kHighest)};
}

void LineLight::set_enabled(bool on) noexcept {
  if (set_line(enable_, on)) {
    on_.store(on, std::memory_order_release);
  } else if (!on) {
    log::error("light", "the LED's line cannot be driven: the monostable must switch it off");
  }
}

int LineLight::sensed_ma() const noexcept { return static_cast<int>(number_in(current_).value_or(kUnknownMa)); }

}  // namespace enamel::fw
