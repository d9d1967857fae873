#include "pipeline/decode/mode_m/micro_saturated.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/decode/mode_m/chosen.hpp"
#include "pipeline/decode/mode_m/micro_spans.hpp"
#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// layout: of the four frames, the code frame second.
constexpr double kTwoPi = 2 * std::numbers::pi, kHalfRootThree = 0.86602540378443865;
constexpr std::array<float, 4> kTimes = {-1.5F, -0.5F, 0.5F, 1.5F};
constexpr std::array<double, 4> kShifts = {0, 0, kTwoPi / 3, -kTwoPi / 3};

struct Wave {
  double value = 0, slope = 0;  ///< cos x + h cos 2x, and its derivative
};

/// By the polynomials that give the same bits everywhere.
Wave wave(double x, double harmonic) {
  const auto half = static_cast<float>(0.5 * std::remainder(x, kTwoPi));
  const auto s = static_cast<double>(sin_poly(half)), c = static_cast<double>(cos_poly(half));
  const double cosine = 1 - 2 * s * s, sine = 2 * s * c;
  return {cosine + harmonic * (2 * cosine * cosine - 1), -sine - 4 * harmonic * sine * cosine};
}

struct Unknowns {
  double mean = 0, modulation = 0, phase = 0;  ///< A above black, B, Phi
};

/// What motion and light do to a pixel, and the gain of its code frame (MicroMotion).
struct Seen {
  PixelChange change;
  float gain;
};

/// One pixel's two phase frames and its code frame.
class UnsaturatedFrames {
 public:
  UnsaturatedFrames(const MicroSaturatedInput& in, const PhaseMaps& m, const Seen& seen, std::size_t i,
                    double saturated_dn)
      : in_(in), change_(seen.change), gain_(static_cast<double>(seen.gain)) {
    const auto a = static_cast<double>(m.mean_dn[i]), c = static_cast<double>(m.cosine_dn[i]);
    const auto s = static_cast<double>(m.sine_dn[i]);
    const std::array<double, 4> dn = {a + c, a + static_cast<double>(m.code_dn[i]), a - 0.5 * c - kHalfRootThree * s,
                                      a - 0.5 * c + kHalfRootThree * s};
    for (std::size_t k = 0; k < dn.size(); ++k) {
      if (!(dn[k] < saturated_dn - kRemadeRounding_dn)) continue;  // false for NaN: the code frame is saturated, too
      if (count_ < 3) frames_[count_] = k, dn_[count_] = dn[k];
      ++count_;
    }
    has_code_ = dn[1] < saturated_dn;
  }

  [[nodiscard]] bool usable() const { return count_ == 3 && has_code_; }

  /// Newton's iteration from `x`; false where it does not converge.
  bool solve(Unknowns& x) const {
    for (int k = 0; k < kMostIterations; ++k) {
      Matrix3d slopes;
      const Vector3d rest = residual(x, slopes);
      const Vector3d step = slopes.partialPivLu().solve(rest);
      if (!step.allFinite()) return false;
      x.mean += step[0], x.modulation += step[1];
      x.phase += std::clamp(step[2], -kLargestOff_rad, kLargestOff_rad);
      if (std::abs(step[2]) < kConverged_rad) return true;
    }
    return false;
  }

  [[nodiscard]] double sigma_rad(const Unknowns& x) const {
    Matrix3d slopes;
    residual(x, slopes);
    const Matrix3d inverse = slopes.inverse();
    double variance = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double per_dn = inverse(2, static_cast<Eigen::Index>(k));
      variance += per_dn * per_dn * static_cast<double>(in_.noise.variance(static_cast<float>(dn_[k])));
    }
    return std::sqrt(variance);
  }

 private:
  /// Frames less the model, and the model's slopes over A, B, Phi.
  Vector3d residual(const Unknowns& x, Matrix3d& slopes) const {
    const double r = 1 + static_cast<double>(in_.code.inverse_ratio), h = -static_cast<double>(in_.third_rad);
    Vector3d rest;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const std::size_t frame = frames_[k];
      const float time = kTimes[frame];
      const double light = static_cast<double>(change_.light(time));
      const double moved = x.phase + static_cast<double>(change_.turned(time));
      const bool code = frame == 1;
      const Wave w = wave(code ? r * moved : moved + kShifts[frame], h);
      const double share = code ? gain_ : 1, turning = code ? r : 1;
      slopes.row(row) << light, light * share * w.value, light * share * x.modulation * w.slope * turning;
      rest[row] = dn_[k] - static_cast<double>(in_.noise.black_dn) - light * (x.mean + share * x.modulation * w.value);
    }
    return rest;
  }

  const MicroSaturatedInput& in_;
  PixelChange change_;
  double gain_;
  std::array<std::size_t, 3> frames_{};
  std::array<double, 3> dn_{};
  std::size_t count_ = 0;
  bool has_code_ = false;
};

class Solver {
 public:
  Solver(const MicroSaturatedInput& in, const PhaseConfig& config, PhaseMaps& maps, Map<std::int16_t>& wraps,
         std::vector<std::size_t>& solved)
      : in_(in), config_(config), maps_(maps), wraps_(wraps), solved_(solved), rows_(in.motion, maps, nullptr) {}

  /// The saturated run between pixels `last` and `next` of the image, both decided, of one row.
  void solve_run(std::size_t last, std::size_t next) {
    const Unknowns a = at(last), b = at(next);
    const double step = b.phase - a.phase;
    const auto carrier = static_cast<double>(in_.carrier_rad[next] - in_.carrier_rad[last]);
    if (!(std::abs(step - carrier) < static_cast<double>(kLargestBend_rad))) return;
    for (std::size_t i = last + 1; i < next; ++i) {
      const double t = static_cast<double>(i - last) / static_cast<double>(next - last);
      solve_pixel(
          i, {a.mean + t * (b.mean - a.mean), a.modulation + t * (b.modulation - a.modulation), a.phase + t * step});
    }
  }

 private:
  [[nodiscard]] Unknowns at(std::size_t i) const {
    return {static_cast<double>(maps_.mean_dn[i] - in_.noise.black_dn), static_cast<double>(maps_.modulation_dn[i]),
            static_cast<double>(maps_.phase_rad[i]) + kTwoPi * wraps_[i]};
  }

  /// Runs come in the order of rows.
  [[nodiscard]] Seen seen_at(std::size_t i) {
    const auto width = static_cast<std::size_t>(maps_.phase_rad.width());
    const auto v = static_cast<int>(i / width);
    if (v != row_) row_ = v, seen_ = rows_.at(v);
    const std::size_t u = i % width;
    return {{seen_.motion_rad[u], seen_.motion_change_rad[u], seen_.light[u], seen_.light_change[u]}, seen_.gain[u]};
  }

  static bool alike(double a, double b) { return a > kLeastAlike * b && b > kLeastAlike * a; }

  void solve_pixel(std::size_t i, const Unknowns& near) {
    const UnsaturatedFrames pixel(in_, maps_, seen_at(i), i,
                                  static_cast<double>(config_.saturation * in_.noise.full_scale_dn));
    Unknowns x = near;
    if (!pixel.usable() || !pixel.solve(x)) return;
    const double sigma = pixel.sigma_rad(x);
    const bool sound = std::abs(x.phase - near.phase) < kLargestOff_rad && alike(x.mean, near.mean) &&
                       alike(x.modulation, near.modulation) && sigma < static_cast<double>(config_.max_sigma_rad);
    if (sound) put(i, x, sigma);
  }

  void put(std::size_t i, const Unknowns& x, double sigma) {
    const double wrap_counts = std::floor(x.phase / kTwoPi + 0.5);
    wraps_[i] = static_cast<std::int16_t>(wrap_counts);
    maps_.phase_rad[i] = static_cast<float>(x.phase - kTwoPi * wrap_counts);
    maps_.sigma_rad[i] = static_cast<float>(sigma);
    maps_.mean_dn[i] = static_cast<float>(x.mean) + in_.noise.black_dn;
    maps_.modulation_dn[i] = static_cast<float>(x.modulation);
    const Wave w = wave(x.phase, 0);
    maps_.cosine_dn[i] = static_cast<float>(x.modulation * w.value);
    maps_.sine_dn[i] = static_cast<float>(-x.modulation * w.slope);
    maps_.reject[i] = PixelReject::kNone;
    solved_.push_back(i);
  }

  const MicroSaturatedInput& in_;
  const PhaseConfig& config_;
  PhaseMaps& maps_;
  Map<std::int16_t>& wraps_;
  std::vector<std::size_t>& solved_;
  CodeRows rows_;
  CodeRow seen_;
  int row_ = -1;
};

}  // namespace

void solve_micro_saturated(const MicroSaturatedInput& input, const PhaseConfig& config, PhaseMaps& maps,
                           Map<std::int16_t>& wraps, std::vector<std::size_t>& solved) {
  solved.clear();
  Solver solver(input, config, maps, wraps, solved);
  for (std::size_t k = 0; k + 1 < input.spans.size(); ++k) {
    const CellSpan &left = input.spans[k], &right = input.spans[k + 1];
    if (left.row != right.row || right.begin <= left.end) continue;
    const std::size_t last = maps.phase_rad.index(left.end - 1, left.row);
    const std::size_t next = maps.phase_rad.index(right.begin, right.row);
    bool saturated = true;
    for (std::size_t i = last + 1; i < next && saturated; ++i) saturated = maps.reject[i] == PixelReject::kSaturated;
    if (saturated) solver.solve_run(last, next);
  }
}

}  // namespace enamel::pipeline
