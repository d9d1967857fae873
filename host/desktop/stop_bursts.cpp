#include "host/desktop/stop_bursts.hpp"

#include <cmath>

namespace enamel::host {
namespace {

constexpr double kSame_deg = 0.01;  // chosen: an encoder's noise is below, the smallest stop of a plan far above

/// NaN equals NaN.
bool same(double a, double b) { return std::isnan(a) ? std::isnan(b) : std::abs(a - b) < kSame_deg; }

}  // namespace

calib::AxisAngles angles_of(const proto::AxesReading& reading) {
  return {reading.rot_cmd_deg * calib::kRadPerDegree, reading.swing_cmd_deg * calib::kRadPerDegree,
          reading.rot_read_deg * calib::kRadPerDegree, reading.swing_read_deg * calib::kRadPerDegree};
}

bool is_same_stop(const proto::AxesReading& a, const proto::AxesReading& b) {
  const bool is_told = !std::isnan(a.rot_cmd_deg) && !std::isnan(a.swing_cmd_deg);
  if (is_told) return same(a.rot_cmd_deg, b.rot_cmd_deg) && same(a.swing_cmd_deg, b.swing_cmd_deg);
  return same(a.rot_read_deg, b.rot_read_deg) && same(a.swing_read_deg, b.swing_read_deg);
}

}  // namespace enamel::host
