#include "pipeline/decode/mode_t/fast_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pipeline/decode/mode_t/chosen.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kFastRowStep = 4, kColumnStep = 2;  ///< layout: strides
/// derived: half of it turns frame 3, 3/2 intervals after mid-burst, by 0.04 rad: a sixth of the tolerance.
constexpr double kStep_rad = 0.05;
constexpr std::size_t kMotions = 2 * kFastSteps + 1;  ///< layout: asked

/// Frame 3 less the measured A, from the measured C and S: of_c C + of_s S +- (sign_c C + sign_s S).
struct Prediction {
  float of_c, of_s, sign_c, sign_s;
};

/// A, C, S of frames (C, -S, -C), which are those above the measured A, when frame k was taken at time k - 1.5.
Prediction prediction_for(double eps) {
  const double a0 = -1.5 * eps, a1 = -0.5 * eps, a2 = 0.5 * eps, a3 = 1.5 * eps;
  // A + C c[k] + S s[k] = x[k]
  const std::array<double, 3> c{std::cos(a0), -std::sin(a1), -std::cos(a2)};
  const std::array<double, 3> s{-std::sin(a0), -std::cos(a1), std::sin(a2)};
  const double det = (c[1] - c[0]) * (s[2] - s[0]) - (c[2] - c[0]) * (s[1] - s[0]);
  const auto solve = [&](const std::array<double, 3>& x) {
    const double x1 = x[1] - x[0], x2 = x[2] - x[0];
    const double of_c = (x1 * (s[2] - s[0]) - x2 * (s[1] - s[0])) / det;
    const double of_s = ((c[1] - c[0]) * x2 - (c[2] - c[0]) * x1) / det;
    return std::array<double, 3>{x[0] - of_c * c[0] - of_s * s[0], of_c, of_s};
  };
  const auto by_c = solve({1, 0, -1}), by_s = solve({0, -1, 0});
  return {static_cast<float>(by_c[0]), static_cast<float>(by_s[0]),
          static_cast<float>(by_c[2] * std::cos(a3) + by_c[1] * std::sin(a3)),
          static_cast<float>(by_s[2] * std::cos(a3) + by_s[1] * std::sin(a3))};
}

struct BlockCount {
  int pixels = 0;
  std::array<int, kMotions> closing{};
};

BlockCount count_block(const PhaseMaps& m, const std::array<Prediction, kMotions>& predictions, int left, int top) {
  BlockCount count;
  const int right = std::min(left + kFastBlock_px, m.phase_rad.width());
  const int bottom = std::min(top + kFastBlock_px, m.phase_rad.height());
  for (int v = top; v < bottom; v += kFastRowStep) {
    for (int u = left; u < right; u += kColumnStep) {
      const std::size_t i = m.phase_rad.index(u, v);
      if (m.reject[i] != PixelReject::kNone) continue;
      ++count.pixels;
      const float c = m.cosine_dn[i], s = m.sine_dn[i], limit = kClosureTolerance * m.modulation_dn[i];
      for (std::size_t k = 0; k < kMotions; ++k) {
        const Prediction& p = predictions[k];
        const float rest = m.code_dn[i] - p.of_c * c - p.of_s * s, sign = p.sign_c * c + p.sign_s * s;
        count.closing[k] += std::min(std::abs(rest - sign), std::abs(rest + sign)) < limit ? 1 : 0;
      }
    }
  }
  return count;
}

}  // namespace

FastMotion explain_by_motion(const PhaseMaps& maps) {
  std::array<Prediction, kMotions> predictions{};
  for (std::size_t k = 0; k < kMotions; ++k)
    predictions[k] = prediction_for(kStep_rad * (static_cast<int>(k) - kFastSteps));
  double seen = 0, closing = 0;
  std::vector<double> motions;
  for (int top = 0; top < maps.phase_rad.height(); top += kFastBlock_px) {
    for (int left = 0; left < maps.phase_rad.width(); left += kFastBlock_px) {
      const BlockCount count = count_block(maps, predictions, left, top);
      if (count.pixels < kFastLeastPixels) continue;
      const auto best = std::max_element(count.closing.begin(), count.closing.end());
      seen += count.pixels;
      closing += *best;
      motions.push_back(kStep_rad * static_cast<double>(best - count.closing.begin() - kFastSteps));
    }
  }
  if (motions.empty()) return {};
  const auto middle = motions.begin() + static_cast<std::ptrdiff_t>(motions.size() / 2);
  std::nth_element(motions.begin(), middle, motions.end());
  return {closing / seen, *middle};
}

}  // namespace enamel::pipeline
