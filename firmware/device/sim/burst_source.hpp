// Where simulated light comes from: the twin renders bursts, the capture player reads them. SIMULATION ONLY.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/base/time.hpp"

namespace enamel::fw {

using SimFrames = std::array<std::vector<std::uint8_t>, 4>;  ///< rows top-down, no padding, little endian

/// When a burst was exposed, device clock.
struct SimExposure {
  DeviceTime first{};  ///< start of the first exposure
  DeviceTime mid{};    ///< middle between its start and the end of the last
  double share = 1;    ///< of the exposure that the source planned
};

/// What the sensor would see during one burst. Times are device clock, ns, of the source's own time base (a capture's
/// original stamps or the twin's trajectory time); the player shifts them to now and keeps their differences.
struct SimBurst {
  std::uint64_t burst_index = 0;
  std::array<std::int64_t, 4> t_exposure_ns{};  ///< start of exposure of each frame
  std::uint32_t exposure_us = 0;
  double temp_c = 0;
  int pattern_set = 0;
  int width = 0;
  int height = 0;
  int bit_depth = 8;
  SimFrames frames;
  /// Light that depends on when it is exposed: called once the burst's last exposure is over, takes its time (its
  /// frames come that much later, stamped as exposed) and makes `frames`. Empty: they are there already.
  std::function<SimFrames(const SimExposure&)> expose = {};
};

class BurstSource {
 public:
  virtual ~BurstSource() = default;
  /// rig.json of the device that made the bursts, byte for byte.
  [[nodiscard]] virtual const std::string& rig_text() const = 0;
  /// The light never was: a twin's, or the recording of one. Pictures and exports then say SIMULATED.
  [[nodiscard]] virtual bool simulated() const { return true; }
  /// How much later than a camera's a burst's frames come, at most: that of SimBurst::expose.
  [[nodiscard]] virtual Nanoseconds lateness() const { return Nanoseconds{0}; }
  /// Number of bursts when known in advance.
  [[nodiscard]] virtual std::optional<std::uint64_t> count() const = 0;
  /// Next burst in order, nullopt at the end.
  [[nodiscard]] virtual Result<std::optional<SimBurst>> next() = 0;
};

}  // namespace enamel::fw
