#include "tests/support/plain_decoder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/plain_steps.hpp"

namespace enamel::test {
namespace plain {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMaxPhaseNoise_rad = 0.15;
/// Phase noise of three frames in units of noise / modulation: 1 on average a quarter of a period apart, 0.8 a third.
constexpr double kThreeFrames = 1.1;
constexpr double kUnsaturated = 250.0 / 255;  ///< of full scale
constexpr double kSlack_mm = 0.7;             ///< of the depth range, where fringes are numbered
constexpr double kMargin_mm = 1.5;            ///< the same, where depth is kept
constexpr int kMaxSteps = 8;
constexpr double kConverged_px = 1e-7;

/// Levels of a frame in the DN of rig.noise, whatever the bits of the burst.
class Levels {
 public:
  Levels(const pipeline::BurstView& view, int noise_bits)
      : view_(view), scale_(std::pow(2.0, noise_bits - view.bit_depth)) {}
  double operator()(std::size_t frame, std::size_t i) const {
    const auto& bytes = view_.frames[frame];
    return scale_ * (view_.bit_depth > 8 ? bytes[2 * i] + 256 * bytes[2 * i + 1] : bytes[i]);
  }

 private:
  const pipeline::BurstView& view_;
  double scale_;
};

/// Mean light A, B sin(phi), B cos(phi).
struct Solution {
  double mean, sine, cosine;
};

/// Frames at 0, 90 and 180 degrees.
Solution quarter_steps(double a, double b, double c) { return {(a + c) / 2, (a + c) / 2 - b, (a - c) / 2}; }

/// Frames at 0, 120 and 240 degrees.
Solution third_steps(double a, double b, double c) {
  return {(a + b + c) / 3, (c - b) / std::numbers::sqrt3, (2 * a - b - c) / 3};
}

double projector_u(const calib::Rig& rig, const calib::RayTable& rays, std::size_t i, double z_mm) {
  return calib::project_to_projector(rig, {rays.x[i], rays.y[i]}, z_mm).x;
}

}  // namespace

Fringes solve_fringes(const calib::Rig& rig, const pipeline::BurstView& view) {
  const auto& n = *rig.noise;
  const bool micro = rig.patterns.mode == calib::PatternMode::kMicro;
  const std::array<std::size_t, 3> shifted =
      micro ? std::array<std::size_t, 3>{0, 2, 3} : std::array<std::size_t, 3>{0, 1, 2};
  const std::size_t coded = micro ? 1 : 3;
  const Levels level(view, n.bits);
  const double read = n.read_noise_e / n.gain_e_per_dn, full = std::pow(2.0, n.bits) - 1;
  const int w = view.width, h = view.height;
  Fringes out{Map<double>(w, h), Map<double>(w, h), Map<double>(w, h), Map<double>(w, h), Map<std::uint8_t>(w, h)};
  for (std::size_t i = 0; i < out.phase_rad.size(); ++i) {
    const double a = level(shifted[0], i), b = level(shifted[1], i), c = level(shifted[2], i);
    const Solution s = micro ? third_steps(a, b, c) : quarter_steps(a, b, c);
    const double modulation = std::hypot(s.sine, s.cosine);
    const double noise = std::sqrt(std::max(s.mean - n.black_dn, 0.0) / n.gain_e_per_dn + read * read + 1.0 / 12);
    out.phase_rad[i] = std::atan2(s.sine, s.cosine);
    out.relative[i] = noise / std::max(modulation, 1e-9);
    out.code_dn[i] = level(coded, i) - s.mean;
    out.wave_dn[i] = micro ? modulation : s.sine;
    out.usable[i] = kThreeFrames * out.relative[i] < kMaxPhaseNoise_rad && std::max({a, b, c}) < kUnsaturated * full &&
                    std::min({a, b, c}) > n.black_dn - 1;
  }
  return out;
}

FringeSpan fringe_span(const calib::Rig& rig, const calib::RayTable& rays) {
  const double near_mm = rig.depth_range->near_mm - kSlack_mm, far_mm = rig.depth_range->far_mm + kSlack_mm;
  FringeSpan out{Map<double>(rays.width, rays.height), Map<double>(rays.width, rays.height)};
  for (std::size_t i = 0; i < out.low.size(); ++i) {
    const double a = projector_u(rig, rays, i, near_mm), b = projector_u(rig, rays, i, far_mm);
    out.low[i] = std::min(a, b) / rig.patterns.period_px;
    out.high[i] = std::max(a, b) / rig.patterns.period_px;
  }
  return out;
}

/// Secants in inverse depth, over which the projector's pixel runs nearly straight.
Map<float> triangulate(const calib::Rig& rig, const calib::RayTable& rays, const Map<double>& phase_rad) {
  const double near_mm = rig.depth_range->near_mm, far_mm = rig.depth_range->far_mm;
  Map<float> out(phase_rad.width(), phase_rad.height(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isnan(phase_rad[i])) continue;
    const double target_px = phase_rad[i] * rig.patterns.period_px / (2 * kPi);
    double before = 1 / near_mm, now = 1 / far_mm;
    double miss_before = projector_u(rig, rays, i, near_mm) - target_px;
    double miss = projector_u(rig, rays, i, far_mm) - target_px;
    for (int step = 0; step < kMaxSteps && std::abs(miss) > kConverged_px && miss != miss_before; ++step) {
      const double next = now - miss * (now - before) / (miss - miss_before);
      before = now, miss_before = miss;
      now = std::clamp(next, 0.5 / far_mm, 2 / near_mm);
      miss = projector_u(rig, rays, i, 1 / now) - target_px;
    }
    const double z_mm = 1 / now;
    if (z_mm > near_mm - kMargin_mm && z_mm < far_mm + kMargin_mm) out[i] = static_cast<float>(z_mm);
  }
  return out;
}

}  // namespace plain

Map<float> plain_decode(const calib::Rig& rig, const pipeline::BurstView& view) {
  const calib::RayTable rays = calib::make_ray_table(rig.camera);
  const plain::Fringes fringes = plain::solve_fringes(rig, view);
  const plain::Segments segments = plain::unwrap_segments(fringes);
  const plain::FringeSpan span = plain::fringe_span(rig, rays);
  return plain::triangulate(rig, rays, plain::number_fringes(rig.patterns, fringes, segments, span));
}

}  // namespace enamel::test
