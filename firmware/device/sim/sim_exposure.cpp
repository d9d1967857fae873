// How long a simulated camera exposes: as its source planned, or as the host asks.
#include <algorithm>
#include <string>

#include "firmware/device/sim/sim_device.hpp"

namespace enamel::fw {
namespace {

constexpr std::uint32_t kShortestUs = 10;
constexpr std::int64_t kMostOfPeriodPercent = 96;  // the rest is for reading out

}  // namespace

/// Whole microseconds, as frames tell them.
void SimDevice::take_exposure(std::uint32_t source_us) {
  const Nanoseconds scaled = timeline_.scale(std::int64_t{source_us} * 1000);
  exposure_ = Nanoseconds{std::max<std::int64_t>(1, scaled.count() / 1000) * 1000};
  light_share_ = 1;
  if (asked_us_ == 0) return;
  const Nanoseconds asked{std::int64_t{asked_us_} * 1000};
  light_share_ = static_cast<double>(asked.count()) / static_cast<double>(exposure_.count());
  exposure_ = asked;
}

Result<void> SimDevice::set_exposure(std::uint32_t exposure_us) {
  if (exposure_us != 0 && !is_made_late_)
    return fail(ErrorCode::kHal, "its pictures were exposed before: the exposure cannot be changed");
  const std::int64_t most_us = mode_.frame_period.count() / 1000 * kMostOfPeriodPercent / 100;
  if (exposure_us != 0 && (exposure_us < kShortestUs || exposure_us > most_us)) {
    return fail(ErrorCode::kConfigValue, "exposure of " + std::to_string(exposure_us) + " us, must be from " +
                                             std::to_string(kShortestUs) + " to " + std::to_string(most_us));
  }
  const std::lock_guard lock(mutex_);
  asked_us_ = exposure_us;
  return {};
}

}  // namespace enamel::fw
