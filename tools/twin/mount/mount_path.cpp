#include "tools/twin/mount/mount_path.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace enamel::twin {
namespace {

class MountPath final : public Trajectory {
 public:
  MountPath(std::vector<Pose> poses, const MountConfig& config, const TimingConfig& timing)
      : poses_(std::move(poses)),
        rate_hz_(timing.burst_rate_hz),
        bursts_(static_cast<std::uint64_t>(config.bursts)),
        moving_(static_cast<std::uint64_t>(std::ceil(config.move_s * timing.burst_rate_hz))) {}

  [[nodiscard]] int bursts() const override { return static_cast<int>(bursts_ * poses_.size()); }

  [[nodiscard]] std::uint64_t slot(std::uint64_t burst) const override {
    return burst + stop_of(burst, static_cast<int>(bursts_), poses_.size()) * moving_;
  }

  /// The axes leap in the middle of the pause, and where there is none, a quarter of a slot before the next burst.
  [[nodiscard]] Pose pose_at(double t_s) const override {
    constexpr double kEarly = 0.25;  // of a slot
    const double period = static_cast<double>(bursts_ + moving_);
    const double early = std::max(kEarly, 0.5 * static_cast<double>(moving_));
    const double stop = std::floor((t_s * rate_hz_ + early) / period);
    return poses_[static_cast<std::size_t>(std::clamp(stop, 0.0, static_cast<double>(poses_.size() - 1)))];
  }

 private:
  std::vector<Pose> poses_;
  double rate_hz_;
  std::uint64_t bursts_, moving_;
};

}  // namespace

std::vector<Pose> mount_poses(const MountRun& run) {
  std::vector<Pose> poses;
  for (const StopTruth& stop : run.stops) poses.push_back(T_model_camera(run.mount, stop));
  return poses;
}

std::unique_ptr<Trajectory> make_mount_path(std::vector<Pose> poses, const MountConfig& config,
                                            const TimingConfig& timing) {
  return std::make_unique<MountPath>(std::move(poses), config, timing);
}

std::size_t stop_of(std::uint64_t burst, int bursts_a_stop, std::size_t stops) {
  return std::min(static_cast<std::size_t>(burst / static_cast<std::uint64_t>(bursts_a_stop)), stops - 1);
}

}  // namespace enamel::twin
