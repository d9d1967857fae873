#include "firmware/control/heater_loop.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::fw {
namespace {

double seconds(Nanoseconds t) { return 1e-9 * static_cast<double>(t.count()); }

}  // namespace

void HeaterLoop::rest() noexcept {
  heats_ = false;
  sum_ = power_ = 0;
  cold_.reset();
}

/// A heater that is driven and does not warm is open, or lies beside the thermistor no more.
void HeaterLoop::watch_rise(double tip_c, double below, HostTime now) {
  if (power_ < 0.5 || below < config_.watched_below_k) return cold_.reset();
  if (!cold_ || tip_c - cold_->tip_c >= config_.least_rise_k) {
    cold_ = Cold{now, tip_c};
  } else if (now - cold_->since >= config_.cold_limit) {
    rest();
    fault_ = proto::ReplyStatus::kHeaterOpen;
  }
}

std::uint16_t HeaterLoop::step(std::optional<std::int16_t> set_point_cc, std::optional<std::int16_t> tip_cc,
                               HostTime now) {
  if (!set_point_cc) {
    rest();
    fault_.reset();
    return 0;
  }
  if (fault_) return 0;
  if (!tip_cc) {
    rest();
    fault_ = proto::ReplyStatus::kThermistor;
    return 0;
  }
  if (*tip_cc >= kCutOffCc) {
    rest();
    return 0;
  }
  if (heats_ && now - last_ < config_.period) return static_cast<std::uint16_t>(std::lround(1000 * power_));
  const double dt = heats_ ? std::min(seconds(now - last_), 1.0) : seconds(config_.period);
  last_ = now;
  heats_ = true;
  const double tip_c = 0.01 * *tip_cc;
  const double below = 0.01 * std::min(*set_point_cc, kMaxSetpointCc) - tip_c;
  const double sum = sum_ + config_.integral * below * dt;
  const double wanted = config_.proportional * below + sum;
  // Only while the power can follow: else it would be far off when the set point is reached.
  if (wanted > 0 && wanted < 1) sum_ = std::clamp(sum, 0.0, 1.0);
  power_ = std::min(std::clamp(wanted, 0.0, 1.0), power_ + config_.slew * dt);
  watch_rise(tip_c, below, now);
  return static_cast<std::uint16_t>(std::lround(1000 * power_));
}

}  // namespace enamel::fw
