// Closed loop of the tip's heater: PI at 5 Hz, slew-limited, without wind-up. Mouth warmth keeps the window clear of
// breath, whose dew point is about 34 degC. Pure; one thread.
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/base/time.hpp"
#include "protocol/types/device.hpp"

namespace enamel::fw {

struct HeaterConfig {
  double proportional = 0.35;              ///< of full power per K below the set point
  double integral = 0.012;                 ///< of full power per K and second
  double slew = 1.0;                       ///< of full power per second, upwards; downwards at once
  Nanoseconds period{200'000'000};         ///< of the loop
  Nanoseconds cold_limit{20'000'000'000};  ///< so long at half power or more …
  double least_rise_k = 1;                 ///< … and not this much warmer: the heater is open …
  double watched_below_k = 2;              ///< … unless the tip is about as warm as it should be
};

class HeaterLoop {
 public:
  explicit HeaterLoop(const HeaterConfig& config = {}) : config_(config) {}

  /// Highest set point that is taken, and where the heater is cut off whatever was asked for, 0.01 degC.
  static constexpr std::int16_t kMaxSetpointCc = 3900, kCutOffCc = 4100;

  /// Power for the time until the next call, 0 … 1000 of full. `set_point_cc`: nullopt: not to heat, which also forgets
  /// a fault. `tip_cc`: nullopt: the thermistor is open or shorted.
  [[nodiscard]] std::uint16_t step(std::optional<std::int16_t> set_point_cc, std::optional<std::int16_t> tip_cc,
                                   HostTime now);
  /// kThermistor, kHeaterOpen; the power is 0 from then on.
  [[nodiscard]] std::optional<proto::ReplyStatus> fault() const noexcept { return fault_; }

 private:
  struct Cold {
    HostTime since{};
    double tip_c = 0;
  };
  void rest() noexcept;
  void watch_rise(double tip_c, double below, HostTime now);

  HeaterConfig config_;
  HostTime last_{};
  bool heats_ = false;
  double sum_ = 0;    ///< of the integral part, of full power
  double power_ = 0;  ///< of full power
  std::optional<Cold> cold_;
  std::optional<proto::ReplyStatus> fault_;
};

}  // namespace enamel::fw
