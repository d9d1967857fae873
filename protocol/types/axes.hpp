// Where the desktop scanner's two axes stood while a burst was taken: a row of axes.csv, which recordings carry as an
// attachment. Degrees, as everything that people and files see.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace enamel::proto {

struct AxesReading {
  std::uint64_t burst_index = 0;
  double rot_cmd_deg = std::numeric_limits<double>::quiet_NaN();  ///< commanded; NaN: none
  double swing_cmd_deg = std::numeric_limits<double>::quiet_NaN();
  double rot_read_deg = std::numeric_limits<double>::quiet_NaN();  ///< read from the axis; NaN: no encoder
  double swing_read_deg = std::numeric_limits<double>::quiet_NaN();

  /// By bits: a reading that is absent in both is the same.
  friend bool operator==(const AxesReading& a, const AxesReading& b) noexcept {
    const auto same = [](double x, double y) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    return a.burst_index == b.burst_index && same(a.rot_cmd_deg, b.rot_cmd_deg) &&
           same(a.swing_cmd_deg, b.swing_cmd_deg) && same(a.rot_read_deg, b.rot_read_deg) &&
           same(a.swing_read_deg, b.swing_read_deg);
  }
};

}  // namespace enamel::proto
