// Where the probe is, at any instant.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tools/twin/path/arch.hpp"

namespace enamel::twin {

using Pose = Eigen::Isometry3d;

/// Burst rhythm of the probe.
struct TimingConfig {
  double burst_rate_hz = 30;
  double frame_period_ms = 4.004;
  double exposure_ms = 3.7;
  double exposure_ratio =
      1;                 ///< every second burst is exposed so many times shorter: what glares in one, the other shows
  double start_s = 1.0;  ///< device clock at the first exposure of burst 0
  int bursts = 0;        ///< 0: as many as the path takes
};

/// Start of exposure of frame k of the burst in a slot of the rhythm (Trajectory::slot), device clock.
[[nodiscard]] std::int64_t exposure_start_ns(const TimingConfig& timing, std::uint64_t slot, int frame);
/// Length of the exposures of burst n.
[[nodiscard]] double exposure_ms(const TimingConfig& timing, std::uint64_t n);
/// Middle between the start of the first and the end of the last exposure of burst n, which lies in `slot`.
[[nodiscard]] std::int64_t mid_burst_ns(const TimingConfig& timing, std::uint64_t slot, std::uint64_t n);

/// Shake of a hand, smooth in time. Frequencies of tremor 8–12 Hz, of wander 0.2–1 Hz; amplitudes are peaks per axis.
struct TremorConfig {
  bool enabled = true;
  double tremor_um = 50, tremor_deg = 0.1;
  double wander_mm = 0.3, wander_deg = 0.8;
  double pivot_mm = 44;  ///< rotations are about this point before the camera
};

class Tremor {
 public:
  Tremor(const TremorConfig& config, std::uint64_t seed);
  /// Motion in the camera's frame, to be applied on the right: T_model_cam * displacement(t).
  [[nodiscard]] Pose displacement(double t_s) const;

 private:
  struct Wave {
    double amplitude, omega, phase;
  };
  static constexpr std::size_t kWavesPerAxis = 4;
  TremorConfig config_;
  std::array<std::array<Wave, kWavesPerAxis>, 6> waves_{};
};

class Trajectory {
 public:
  virtual ~Trajectory() = default;
  /// T_model_cam without tremor at t seconds after the first exposure of burst 0.
  [[nodiscard]] virtual Pose pose_at(double t_s) const = 0;
  /// As many as the probe takes on the whole way.
  [[nodiscard]] virtual int bursts() const = 0;
  /// Place of burst n in the probe's rhythm, counted from the first burst. A paused probe numbers on without a hole
  /// while its clock goes on: behind a pause the slot is larger than n.
  [[nodiscard]] virtual std::uint64_t slot(std::uint64_t burst) const { return burst; }
};

/// One stand (or straight flight) of the probe before an artefact. The model's z axis points to the probe at tilt 0;
/// image x runs along model x.
struct ViewConfig {
  double distance_mm = 48;
  double tilt_x_deg = 0, tilt_y_deg = 0, roll_deg = 0;
  std::array<double, 3> target_mm{};      ///< model point on the optical axis
  std::array<double, 3> velocity_mm_s{};  ///< camera frame
  std::array<double, 3> turn_deg_s{};     ///< rotation vector per second about the target, camera frame
  int bursts = 1;
};

[[nodiscard]] std::unique_ptr<Trajectory> make_views(std::vector<ViewConfig> views, const TimingConfig& timing);

/// How the hand comes from the pass before.
enum class Joint : std::uint8_t {
  kTurn,   ///< in one smooth turn, bursts going on
  kPause,  ///< the probe is paused meanwhile; the pass begins at its own place and angle
};

struct PassConfig {
  double from_mm = 4, to_mm = 48;  ///< arc length along the arch
  double roll_deg = 0;             ///< about the arch's tangent; > 0: the probe stands on the cheek side
  double height_mm = 4;            ///< z of the point looked at, above the gum margin
  double offset_mm = 0;            ///< of that point from the arch, outwards; < 0: on the tongue's side
  Joint after = Joint::kTurn;
  double pause_s = 1.0;  ///< from the end of the pass before, when after a pause
  double spin_deg = 0;   ///< about the viewing axis, clockwise as the camera sees it
};

/// The probe is paused while the hand goes on.
struct GapConfig {
  int pass = 0;      ///< counted from 0
  double at_mm = 0;  ///< arc length at which it begins
  int bursts = 14;   ///< left out
};

struct ArchPathConfig {
  std::vector<PassConfig> passes;
  std::vector<GapConfig> gaps;
  double speed_mm_s = 15;  ///< mean of a pass
  double surge_mm_s = 0;   ///< the speed swings by so much about it, whole periods a pass
  double surge_s = 1;      ///< length of a period, about
  double turn_s = 0.9;     ///< from the end of a pass to the beginning of the next
  double distance_mm = 48;
  double from_s = 0;  ///< no burst before that time; the hand is under way
};

[[nodiscard]] std::unique_ptr<Trajectory> make_arch_path(const ArchPathConfig& config, const Arch& arch,
                                                         const TimingConfig& timing);

}  // namespace enamel::twin
