// A desktop scanner's light: the table stands where a simulated controller's motors took it when a burst is exposed,
// instead of following the scene's stops. SIMULATION ONLY.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/device/sim/burst_source.hpp"
#include "protocol/base/clock.hpp"
#include "tools/twin/axes/grbl_model.hpp"
#include "tools/twin/mount/live_mount.hpp"

namespace enamel::twin {

/// What goes wrong with the axes, in the movement of this number (a line of the host that turns something is one).
struct TableFault {
  LostStep lost;
  GrblFault fault = GrblFault::kNone;  ///< strikes half-way
  int movement = 0;
};

/// "lose-step@N", "hard-limit@N", "restart@N", "power-off@N", "unplug@N", "hang@N"; empty: none. kUsage.
[[nodiscard]] Result<TableFault> parse_table_fault(std::string_view text);

struct LiveTableOptions {
  std::string scene;
  std::optional<std::uint64_t> seed;  ///< overrides the scene's
  std::string port;                   ///< name of the controller's serial port
  TableFault fault;
  std::string truth;    ///< table of what every burst showed; empty: none
  std::string surface;  ///< PLY of the whole surface and in how many bursts each vertex was seen, at the end; empty: none
};

/// The controller works while the source lives. kConfigValue: the scene has no mount; kHal, kFileWrite; those of the
/// scene. `clock`: real time, the device's as well; must outlive the source.
[[nodiscard]] Result<std::unique_ptr<fw::BurstSource>> open_live_table(const LiveTableOptions& options, Clock& clock);

/// First line of the truth. A row a burst that was exposed, whoever took it; angles: where the motors stood, where the
/// table did (harmonics in); pose: T_model_camera, mm. Told at mid-burst; `moving` is 1 when it moved at any time of
/// the burst.
inline constexpr std::string_view kTableTruthHeader =
    "t_first_exposure_ns,t_mid_ns,moving,rot_motor_deg,swing_motor_deg,rot_deg,swing_deg,tx,ty,tz,qx,qy,qz,qw";

}  // namespace enamel::twin
