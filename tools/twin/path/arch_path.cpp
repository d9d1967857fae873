// A hand that goes along the teeth: pass after pass, joined by turns or by pauses of the probe.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tools/twin/degrees.hpp"
#include "tools/twin/path/burst_slots.hpp"
#include "tools/twin/path/trajectory.hpp"

namespace enamel::twin {
namespace {

using Eigen::Vector3d;

struct ArchState {
  double s, roll_deg, height, offset, spin_deg;
};

class ArchPath final : public Trajectory {
 public:
  ArchPath(const ArchPathConfig& config, const Arch& arch, const TimingConfig& timing)
      : config_(config), arch_(arch), timing_(timing) {
    for (std::size_t i = 0; i < config_.passes.size(); ++i) {
      if (i > 0) end_s_ += joint_s(config_.passes[i]);
      begin_s_.push_back(end_s_);
      end_s_ += duration(config_.passes[i]);
    }
    slots_ = BurstSlots(quiet());
  }
  [[nodiscard]] int bursts() const override {
    return slots_.bursts_within(static_cast<int>(end_s_ * timing_.burst_rate_hz));
  }
  [[nodiscard]] std::uint64_t slot(std::uint64_t burst) const override { return slots_.slot(burst); }

  [[nodiscard]] Pose pose_at(double t_s) const override {
    const ArchState a = state_at(t_s);
    const Eigen::Vector2d p = arch_.point(a.s), t = arch_.tangent(a.s), b = arch_.buccal(a.s);
    const Vector3d x(t.x(), t.y(), 0), up(0, 0, 1), out(b.x(), b.y(), 0);
    const Vector3d target = Vector3d(p.x(), p.y(), a.height) + a.offset * out;
    const double roll = a.roll_deg * kRadPerDeg;
    const Vector3d z = -(std::cos(roll) * up + std::sin(roll) * out);
    Pose pose = Pose::Identity();
    pose.linear().col(0) = x;
    pose.linear().col(1) = z.cross(x);
    pose.linear().col(2) = z;
    if (a.spin_deg != 0) pose.rotate(Eigen::AngleAxisd(a.spin_deg * kRadPerDeg, Vector3d::UnitZ()));
    pose.translation() = target - config_.distance_mm * z;
    return pose;
  }

 private:
  static double length(const PassConfig& p) { return std::abs(p.to_mm - p.from_mm); }
  [[nodiscard]] double duration(const PassConfig& p) const { return length(p) / config_.speed_mm_s; }
  static double direction(const PassConfig& p) { return p.to_mm >= p.from_mm ? 1.0 : -1.0; }
  /// Where passes begin and end: a surge is at its zero there.
  [[nodiscard]] double velocity(const PassConfig& p) const { return direction(p) * config_.speed_mm_s; }

  /// Way along a pass dt after its beginning.
  [[nodiscard]] double way(const PassConfig& p, double dt) const {
    const double even = config_.speed_mm_s * dt, whole = duration(p);
    if (config_.surge_mm_s == 0 || whole == 0) return even;
    const double omega = 2 * std::numbers::pi * std::max(1.0, std::round(whole / config_.surge_s)) / whole;
    return even + config_.surge_mm_s / omega * (1.0 - std::cos(omega * dt));
  }

  /// Its inverse: the way only grows.
  [[nodiscard]] double time_of(const PassConfig& p, double way_mm) const {
    if (config_.surge_mm_s == 0) return way_mm / config_.speed_mm_s;
    double low = 0, high = duration(p);
    constexpr int kHalvings = 50;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high);
      (way(p, middle) < way_mm ? low : high) = middle;
    }
    return high;
  }
  /// From the end of the pass before.
  [[nodiscard]] double joint_s(const PassConfig& p) const {
    return p.after == Joint::kPause ? p.pause_s : config_.turn_s;
  }

  [[nodiscard]] std::vector<Quiet> quiet() const {
    const double rate = timing_.burst_rate_hz;
    const double burst_s = 1e-3 * (3 * timing_.frame_period_ms + timing_.exposure_ms);
    std::vector<Quiet> out{{0, static_cast<std::int64_t>(std::ceil(config_.from_s * rate))}};
    for (std::size_t i = 1; i < config_.passes.size(); ++i) {
      const PassConfig& p = config_.passes[i];
      if (p.after != Joint::kPause) continue;
      // No burst may see the hand leap: the last one before is over when the pause begins.
      const double from = begin_s_[i] - p.pause_s - burst_s;
      out.push_back({static_cast<std::int64_t>(std::floor(from * rate)) + 1,
                     static_cast<std::int64_t>(std::ceil(begin_s_[i] * rate))});
    }
    for (const GapConfig& g : config_.gaps) {
      const auto i = static_cast<std::size_t>(g.pass);
      const double at = begin_s_[i] + time_of(config_.passes[i], std::abs(g.at_mm - config_.passes[i].from_mm));
      const auto first = static_cast<std::int64_t>(std::ceil(at * rate));
      out.push_back({first, first + g.bursts});
    }
    return out;
  }

  [[nodiscard]] ArchState state_at(double t_s) const {
    std::size_t i = 0;
    while (i + 1 < begin_s_.size() && t_s >= begin_s_[i + 1]) ++i;
    const PassConfig& pass = config_.passes[i];
    const double dt = t_s - begin_s_[i];
    if (dt <= duration(pass) || i + 1 == config_.passes.size()) {
      return {pass.from_mm + direction(pass) * way(pass, dt), pass.roll_deg, pass.height_mm, pass.offset_mm,
              pass.spin_deg};
    }
    const PassConfig& next = config_.passes[i + 1];
    if (next.after == Joint::kPause) {  // seen by no burst
      return {pass.to_mm, pass.roll_deg, pass.height_mm, pass.offset_mm, pass.spin_deg};
    }
    return turned(pass, next, (dt - duration(pass)) / config_.turn_s);
  }

  /// Turn, u from 0 to 1: the position follows a cubic that keeps the velocity at both ends, roll, height, offset and
  /// spin a smooth step.
  [[nodiscard]] ArchState turned(const PassConfig& pass, const PassConfig& next, double u) const {
    const double u2 = u * u, u3 = u2 * u;
    const double m0 = velocity(pass) * config_.turn_s, m1 = velocity(next) * config_.turn_s;
    const double step = u3 * (u * (6.0 * u - 15.0) + 10.0);
    return {
        (2 * u3 - 3 * u2 + 1) * pass.to_mm + (u3 - 2 * u2 + u) * m0 + (3 * u2 - 2 * u3) * next.from_mm + (u3 - u2) * m1,
        pass.roll_deg + step * (next.roll_deg - pass.roll_deg),
        pass.height_mm + step * (next.height_mm - pass.height_mm),
        pass.offset_mm + step * (next.offset_mm - pass.offset_mm),
        pass.spin_deg + step * (next.spin_deg - pass.spin_deg)};
  }

  ArchPathConfig config_;
  Arch arch_;
  TimingConfig timing_;
  std::vector<double> begin_s_;
  double end_s_ = 0;
  BurstSlots slots_{{}};
};

}  // namespace

std::unique_ptr<Trajectory> make_arch_path(const ArchPathConfig& config, const Arch& arch, const TimingConfig& timing) {
  return std::make_unique<ArchPath>(config, arch, timing);
}

}  // namespace enamel::twin
