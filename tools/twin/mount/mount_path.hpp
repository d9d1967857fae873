// The mount's stops as the probe's path: the object moves, so in its frame the camera does.
#pragma once

#include <memory>

#include "tools/twin/mount/mount.hpp"
#include "tools/twin/path/trajectory.hpp"

namespace enamel::twin {

/// T_model_camera of every stop of a run.
[[nodiscard]] std::vector<Pose> mount_poses(const MountRun& run);

/// config.bursts bursts at each stop, at rest; the probe is paused for config.move_s (whole slots of its rhythm) while
/// the axes move. Behind the last stop it stays there. Precondition: poses is not empty.
[[nodiscard]] std::unique_ptr<Trajectory> make_mount_path(std::vector<Pose> poses, const MountConfig& config,
                                                          const TimingConfig& timing);

/// Stop at which burst n is taken, of `stops`.
[[nodiscard]] std::size_t stop_of(std::uint64_t burst, int bursts_a_stop, std::size_t stops);

}  // namespace enamel::twin
