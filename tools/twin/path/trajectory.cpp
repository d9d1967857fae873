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

struct ArchState {
  double s, roll_deg, height;
};

class ArchPath final : public Trajectory {
 public:
  ArchPath(const ArchPathConfig& config, const Arch& arch, const TimingConfig& timing)
      : config_(config), arch_(arch), timing_(timing) {
    for (std::size_t i = 0; i < config_.passes.size(); ++i) {
      begin_s_.push_back(end_s_);
      end_s_ += length(config_.passes[i]) / config_.speed_mm_s + (i + 1 < config_.passes.size() ? config_.turn_s : 0.0);
    }
  }
  [[nodiscard]] int bursts() const override { return static_cast<int>(end_s_ * timing_.burst_rate_hz); }

  [[nodiscard]] Pose pose_at(double t_s) const override {
    const ArchState a = state_at(t_s);
    const Eigen::Vector2d p = arch_.point(a.s), t = arch_.tangent(a.s), b = arch_.buccal(a.s);
    const Vector3d target(p.x(), p.y(), a.height);
    const Vector3d x(t.x(), t.y(), 0), up(0, 0, 1), out(b.x(), b.y(), 0);
    const double roll = a.roll_deg * kRadPerDeg;
    const Vector3d z = -(std::cos(roll) * up + std::sin(roll) * out);
    Pose pose = Pose::Identity();
    pose.linear().col(0) = x;
    pose.linear().col(1) = z.cross(x);
    pose.linear().col(2) = z;
    pose.translation() = target - config_.distance_mm * z;
    return pose;
  }

 private:
  static double length(const PassConfig& p) { return std::abs(p.to_mm - p.from_mm); }
  [[nodiscard]] double velocity(const PassConfig& p) const {
    return p.to_mm >= p.from_mm ? config_.speed_mm_s : -config_.speed_mm_s;
  }

  [[nodiscard]] ArchState state_at(double t_s) const {
    std::size_t i = 0;
    while (i + 1 < begin_s_.size() && t_s >= begin_s_[i + 1]) ++i;
    const PassConfig& pass = config_.passes[i];
    const double dt = t_s - begin_s_[i], duration = length(pass) / config_.speed_mm_s;
    if (dt <= duration || i + 1 == config_.passes.size()) {
      return {pass.from_mm + velocity(pass) * dt, pass.roll_deg, pass.height_mm};
    }
    // Turn: the position follows a cubic that keeps the velocity at both ends, roll and height a smooth step.
    const PassConfig& next = config_.passes[i + 1];
    const double u = (dt - duration) / config_.turn_s, u2 = u * u, u3 = u2 * u;
    const double m0 = velocity(pass) * config_.turn_s, m1 = velocity(next) * config_.turn_s;
    const double step = u3 * (u * (6.0 * u - 15.0) + 10.0);
    return {
        (2 * u3 - 3 * u2 + 1) * pass.to_mm + (u3 - 2 * u2 + u) * m0 + (3 * u2 - 2 * u3) * next.from_mm + (u3 - u2) * m1,
        pass.roll_deg + step * (next.roll_deg - pass.roll_deg),
        pass.height_mm + step * (next.height_mm - pass.height_mm)};
  }

  ArchPathConfig config_;
  Arch arch_;
  TimingConfig timing_;
  std::vector<double> begin_s_;
  double end_s_ = 0;
};

}  // namespace

std::int64_t exposure_start_ns(const TimingConfig& timing, std::uint64_t burst, int frame) {
  return std::llround(1e9 * (timing.start_s + static_cast<double>(burst) / timing.burst_rate_hz)) +
         std::llround(1e6 * timing.frame_period_ms * frame);
}

std::int64_t mid_burst_ns(const TimingConfig& timing, std::uint64_t burst) {
  return (exposure_start_ns(timing, burst, 0) + exposure_start_ns(timing, burst, 3) +
          std::llround(1e6 * timing.exposure_ms)) /
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

std::unique_ptr<Trajectory> make_arch_path(const ArchPathConfig& config, const Arch& arch, const TimingConfig& timing) {
  return std::make_unique<ArchPath>(config, arch, timing);
}

}  // namespace enamel::twin
