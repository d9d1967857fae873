#include "host/desktop/stop_bursts.hpp"

namespace enamel::host {
calib::AxisAngles angles_of(const proto::AxesReading& reading) {
  return {reading.rot_cmd_deg * calib::kRadPerDegree, reading.swing_cmd_deg * calib::kRadPerDegree,
          reading.rot_read_deg * calib::kRadPerDegree, reading.swing_read_deg * calib::kRadPerDegree};
}

}  // namespace enamel::host
