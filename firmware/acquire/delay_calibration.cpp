#include "firmware/acquire/delay_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace enamel::fw {

std::int64_t median_of(std::vector<std::int64_t> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

void DelayCalibration::on_strobe(DeviceTime t) {
  strobes_.push_back(t);
  if (strobes_.size() > 8) strobes_.erase(strobes_.begin());
}

void DelayCalibration::on_frame(DeviceTime t_sensor, std::uint32_t exposure_us) {
  if (complete()) return;
  const auto last = std::find_if(strobes_.rbegin(), strobes_.rend(), [&](DeviceTime t) { return t < t_sensor; });
  if (last == strobes_.rend()) return;
  delays_.push_back((t_sensor - *last).count() - std::int64_t{exposure_us} * 1000);
}

std::optional<StampDelay> DelayCalibration::result() const {
  if (!complete() || delays_.empty()) return std::nullopt;
  const std::int64_t median = median_of(delays_);
  std::vector<std::int64_t> deviation;
  deviation.reserve(delays_.size());
  for (const std::int64_t d : delays_) deviation.push_back(std::abs(d - median));
  return StampDelay{Nanoseconds{median}, Nanoseconds{median_of(std::move(deviation))}};
}

}  // namespace enamel::fw
