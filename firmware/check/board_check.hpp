// Proves a device as a probe: its frames come at the rate that its mode states, its stamps tell which frame saw which
// pattern, the light does as it is told, bursts come whole.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/acquire/acquisition.hpp"
#include "firmware/device/device.hpp"

namespace enamel::fw {

/// One thing that was looked at, in the order of looking.
struct CheckFinding {
  std::string part;                ///< "frames", "stamps", "light", "bursts", "picture", or what a board is opened of
  std::string found;               ///< figures, or what is wrong
  std::optional<ErrorCode> fault;  ///< nullopt: good
};

struct CheckConfig {
  int bursts = 20;
  std::uint64_t least_patience = 600;  ///< frames without a burst, or for the stamps to be measured
  std::size_t frames = 60;             ///< for the rate
  double rate_tolerance = 0.002;       ///< of the frame period: beyond, the sensor keeps its own
  double least_mean_dn = 8;            ///< of lit frames, in 8-bit levels: darker, nothing reflects or the light is off
  double most_saturated = 0.2;         ///< of their pixels
  /// Called while the acquisition is at work, with its silence: sleeps a little, feeds a watchdog. False: no more.
  std::function<bool(Nanoseconds)> meanwhile = {};
  std::function<void(const CheckFinding&)> found = {};  ///< called with each finding as it comes
};

/// The four frames of one burst, as they travel.
struct CheckPicture {
  int width = 0, height = 0, bit_depth = 8;
  std::vector<std::uint8_t> bytes;
};

struct CheckReport {
  std::vector<CheckFinding> findings;
  std::optional<CheckPicture> picture;
  [[nodiscard]] bool good() const noexcept;
};

/// Stops at the first part that fails, since the others need it; the light is off afterwards.
[[nodiscard]] CheckReport check_device(Device& device, Clock& clock, const CheckConfig& config);

/// Four frames side by side as a binary PGM, which needs no library. Depths above 8 keep their bits.
[[nodiscard]] std::string pgm_of(const CheckPicture& picture);

}  // namespace enamel::fw
