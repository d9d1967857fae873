#include "tools/twin/path/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tools/twin/degrees.hpp"
#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

using Eigen::Vector3d;

Eigen::AngleAxisd turn(double deg, const Vector3d& axis) { return {deg * kRadPerDeg, axis}; }

Eigen::Matrix3d rotation(const Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
}

Vector3d to_vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

double mid_burst_s(const TimingConfig& timing, int burst) {
  return burst / timing.burst_rate_hz + 0.5e-3 * (3 * timing.frame_period_ms + timing.exposure_ms);
}

class Views final : public Trajectory {
 public:
  Views(std::vector<ViewConfig> views, const TimingConfig& timing) : views_(std::move(views)), timing_(timing) {
    for (const auto& v : views_) total_ += v.bursts;
  }
  [[nodiscard]] int bursts() const override { return total_; }

  [[nodiscard]] Pose pose_at(double t_s) const override {
    // The pose stated is that of the middle of the view's first burst.
    int first = 0;
    std::size_t i = 0;
    const double slot = 1.0 / timing_.burst_rate_hz;
    for (; i + 1 < views_.size() && t_s >= (first + views_[i].bursts) * slot - 0.25 * slot; ++i) {
      first += views_[i].bursts;
    }
    return at(views_[i], t_s - mid_burst_s(timing_, first));
  }

 private:
  static Pose at(const ViewConfig& v, double dt) {
    Pose pose = Pose::Identity();
    pose.translate(to_vector(v.target_mm));
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));  // camera z looks down on the model
    pose.rotate(turn(v.tilt_x_deg, Vector3d::UnitX()));
    pose.rotate(turn(v.tilt_y_deg, Vector3d::UnitY()));
    pose.rotate(turn(v.roll_deg, Vector3d::UnitZ()));
    pose.rotate(rotation(to_vector(v.turn_deg_s) * (kRadPerDeg * dt)));
    pose.translate(Vector3d(0, 0, -v.distance_mm) + to_vector(v.velocity_mm_s) * dt);
    return pose;
  }

  std::vector<ViewConfig> views_;
  TimingConfig timing_;
  int total_ = 0;
};

}  // namespace

std::int64_t exposure_start_ns(const TimingConfig& timing, std::uint64_t slot, int frame) {
  return std::llround(1e9 * (timing.start_s + static_cast<double>(slot) / timing.burst_rate_hz)) +
         std::llround(1e6 * timing.frame_period_ms * frame);
}

double exposure_ms(const TimingConfig& timing, std::uint64_t n) {
  return n % 2 == 0 ? timing.exposure_ms : timing.exposure_ms / timing.exposure_ratio;
}

std::int64_t mid_burst_ns(const TimingConfig& timing, std::uint64_t slot, std::uint64_t n) {
  return (exposure_start_ns(timing, slot, 0) + exposure_start_ns(timing, slot, 3) +
          std::llround(1e6 * exposure_ms(timing, n))) /
         2;
}

Tremor::Tremor(const TremorConfig& config, std::uint64_t seed) : config_(config) {
  constexpr std::uint64_t kStream = 0x7472656D6F72;
  const CounterRandom random(seed, kStream);
  std::uint64_t counter = 0;
  for (std::size_t axis = 0; axis < waves_.size(); ++axis) {
    const bool turns = axis >= 3;
    for (std::size_t i = 0; i < kWavesPerAxis; ++i) {
      const bool fast = i < 2;
      const double fast_peak = turns ? config.tremor_deg * kRadPerDeg : config.tremor_um * 1e-3;
      const double slow_peak = turns ? config.wander_deg * kRadPerDeg : config.wander_mm;
      const double share = random.uniform(counter++, 0.35, 0.65);
      const double hz = fast ? random.uniform(counter++, 8.0, 12.0) : random.uniform(counter++, 0.2, 1.0);
      const double phase = random.uniform(counter++, 0.0, 2.0 * std::numbers::pi);
      waves_[axis][i] = {share * (fast ? fast_peak : slow_peak), 2.0 * std::numbers::pi * hz, phase};
    }
  }
}

Pose Tremor::displacement(double t_s) const {
  if (!config_.enabled) return Pose::Identity();
  std::array<double, 6> value{};
  for (std::size_t axis = 0; axis < waves_.size(); ++axis) {
    for (const auto& w : waves_[axis]) value[axis] += w.amplitude * std::sin(w.omega * t_s + w.phase);
  }
  Pose out = Pose::Identity();
  out.translate(Vector3d(value[0], value[1], config_.pivot_mm + value[2]));
  out.rotate(rotation(Vector3d(value[3], value[4], value[5])));
  out.translate(Vector3d(0, 0, -config_.pivot_mm));
  return out;
}

std::unique_ptr<Trajectory> make_views(std::vector<ViewConfig> views, const TimingConfig& timing) {
  return std::make_unique<Views>(std::move(views), timing);
}

}  // namespace enamel::twin
