#include "firmware/updater/probe_services.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <utility>

#include "firmware/updater/self_test.hpp"

namespace enamel::fw {
namespace {

constexpr long kLeastChargePercent = 30;
/// Hosts give up a transfer after five seconds.
constexpr std::chrono::milliseconds kWhileHostWaits{4000};

/// The number in a file of sysfs.
std::optional<long> read_number(const std::string& path) noexcept {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  std::array<char, 32> text{};
  const ssize_t n = ::read(fd, text.data(), text.size());
  ::close(fd);
  long value = 0;
  if (n <= 0 || std::from_chars(text.data(), text.data() + n, value).ec != std::errc()) return std::nullopt;
  return value;
}

}  // namespace

ProbeServices::ProbeServices(const UpdaterOptions& options, std::string slot_name, ScanLock* lock, Clock& clock)
    : options_(&options), lock_(lock), clock_(&clock), slot_name_(std::move(slot_name)) {}

void ProbeServices::let_scan() noexcept {
  if (lock_ != nullptr) lock_->release();
}

std::uint16_t ProbeServices::battery_mv() const noexcept {
  if (options_->battery.empty()) return 0;
  const std::optional<long> microvolt = read_number(options_->battery + "/voltage_now");
  constexpr long kMost = std::numeric_limits<std::uint16_t>::max();
  return microvolt ? static_cast<std::uint16_t>(std::clamp(*microvolt / 1000, 0L, kMost)) : std::uint16_t{0};
}

bool ProbeServices::power_suffices() const noexcept {
  if (options_->battery.empty()) return true;
  const std::optional<long> charge_percent = read_number(options_->battery + "/capacity");
  return charge_percent && *charge_percent >= kLeastChargePercent;
}

std::optional<std::size_t> ProbeServices::read_calibration(std::size_t offset, std::span<std::byte> out) noexcept {
  if (options_->calibration.empty()) return std::nullopt;
  const int fd = ::open(options_->calibration.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  const ssize_t n = ::pread(fd, out.data(), out.size(), static_cast<off_t>(offset));
  ::close(fd);
  return n < 0 ? std::nullopt : std::optional(static_cast<std::size_t>(n));
}

bool ProbeServices::self_test() noexcept { return self_test(kWhileHostWaits); }

bool ProbeServices::self_test(std::chrono::milliseconds limit) noexcept {
  return options_->self_test.empty() || run_self_test(options_->self_test, slot_name_, *clock_, limit);
}

}  // namespace enamel::fw
