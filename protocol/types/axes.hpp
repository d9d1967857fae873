// Where the desktop scanner's two axes stood while a burst was taken: a message of its own (scanner.idl), on the wire
// and in recordings, and a row of axes.csv. Degrees, as everything that people and files see.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace enamel::proto {

/// chosen: a turn, and what the travel reaches beyond its ends (config/desktop/grbl.toml: -1 to 361) with room for the
/// error of an encoder. Beyond it is no angle, or one with full turns in it that belong taken off.
inline constexpr double kMaxAxisAngle_deg = 370;

struct AxesReading {
  std::uint64_t burst_index = 0;
  double rot_cmd_deg = std::numeric_limits<double>::quiet_NaN();  ///< commanded; NaN: none
  double swing_cmd_deg = std::numeric_limits<double>::quiet_NaN();
  double rot_read_deg = std::numeric_limits<double>::quiet_NaN();  ///< read from the axis; NaN: no encoder
  double swing_read_deg = std::numeric_limits<double>::quiet_NaN();
  std::uint32_t probe_id = 0;    ///< key; 0 where no probe took the burst
  std::uint32_t session_id = 0;  ///< of the burst: its number begins anew with the probe
  std::uint32_t stop = 0;        ///< from 0 within the session; bursts of one stop see the same pose

  /// Whether it says of both axes where they stood.
  [[nodiscard]] bool is_whole() const noexcept {
    return !(std::isnan(rot_cmd_deg) && std::isnan(rot_read_deg)) &&
           !(std::isnan(swing_cmd_deg) && std::isnan(swing_read_deg));
  }
  /// By bits: an angle that is absent in both is the same.
  [[nodiscard]] bool has_angles_of(const AxesReading& other) const noexcept {
    const auto same = [](double x, double y) {
      return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
    };
    return same(rot_cmd_deg, other.rot_cmd_deg) && same(swing_cmd_deg, other.swing_cmd_deg) &&
           same(rot_read_deg, other.rot_read_deg) && same(swing_read_deg, other.swing_read_deg);
  }
  friend bool operator==(const AxesReading& a, const AxesReading& b) noexcept {
    return a.burst_index == b.burst_index && a.probe_id == b.probe_id && a.session_id == b.session_id &&
           a.stop == b.stop && a.has_angles_of(b);
  }
};

}  // namespace enamel::proto
