#include "pipeline/algo/unwrap/code_steps.hpp"

#include <algorithm>
#include <cstdlib>

namespace enamel::algo {
namespace {

constexpr std::size_t kGap_px = 1;     ///< pixels left out on either side of a border
constexpr std::size_t kWindow_px = 4;  ///< pixels fitted on either side
constexpr std::size_t kReach_px = kGap_px + kWindow_px;
constexpr int kMostOrders = 3;
constexpr float kRidge = 1e-2F;
constexpr float kNoJump = 1e30F;

/// Reduction of the sum of squares by the best z: h N^-1 h.
inline float explained(const CodeSums& s) noexcept {
  const float a = s.xx + kRidge, d = s.yy + kRidge;
  return (d * s.xd * s.xd - 2 * s.xy * s.xd * s.yd + a * s.yd * s.yd) / (a * d - s.xy * s.xy);
}

/// The sums of w exp(i turn): as if the pixels lay some orders on.
CodeSums turned(const CodeSums& s, float c, float n) {
  // x = Re w, y = -Im w: x' = c x + n y, y' = c y - n x.
  return {c * c * s.xx + 2 * c * n * s.xy + n * n * s.yy,
          (c * c - n * n) * s.xy + c * n * (s.yy - s.xx),
          n * n * s.xx - 2 * c * n * s.xy + c * c * s.yy,
          c * s.xd + n * s.yd,
          c * s.yd - n * s.xd,
          s.dd};
}

CodeSums operator+(const CodeSums& a, const CodeSums& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.yy + b.yy, a.xd + b.xd, a.yd + b.yd, a.dd + b.dd};
}

CodeSums window(const CodeSums* first) {
  CodeSums s;
  for (std::size_t k = 0; k < kWindow_px; ++k) s = s + first[k];
  return s;
}

/// Turns each pixel's sums by its flood's turn, so that they belong to one surface's unwrapped phase.
void unwrap_sums(const FloodMaps& flood, const MicroCode& code, std::size_t at, std::vector<CodeSums>& sums) {
  for (std::size_t u = 0; u < sums.size(); ++u) {
    const int turn = flood.turn[at + u];
    if (flood.component[at + u] < 0 || turn == 0) continue;
    const auto k = std::min(static_cast<std::size_t>(std::abs(turn)), code.cosine.size() - 1);
    sums[u] = turned(sums[u], code.cosine[k], turn < 0 ? -code.sine[k] : code.sine[k]);
  }
}

/// Half the squares that a jump at the border left of u leaves unexplained; kNoJump unless the jump is a better
/// explanation than none by `cost`. Two independent fits, than which no jump can do better, are tried first.
float misfit_of_jump(const CodeSums* sums, std::size_t u, const MicroCode& code, float cost) {
  const CodeSums left = window(sums + (u - kReach_px)), right = window(sums + (u + kGap_px));
  const float same = explained(left + right);
  if (0.5F * (explained(left) + explained(right) - same) < cost) return kNoJump;
  float best = 0;
  for (std::size_t d = 1; d <= kMostOrders; ++d) {
    for (const float sign : {-1.0F, 1.0F})
      best = std::max(best, explained(left + turned(right, code.cosine[d], sign * code.sine[d])));
  }
  return 0.5F * (best - same) > cost ? 0.5F * (left.dd + right.dd - best) : kNoJump;
}

bool one_component(const FloodMaps& flood, std::size_t first, std::size_t count) {
  const std::int32_t c = flood.component[first];
  if (c < 0) return false;
  for (std::size_t k = 1; k < count; ++k)
    if (flood.component[first + k] != c) return false;
  return true;
}

}  // namespace

void find_code_steps(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, const FloodMaps& flood,
                     float cost, CodeSteps& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  if (out.cut.width() != w || out.cut.height() != h) out.cut = Map<std::uint8_t>(w, h);
  std::fill(out.cut.pixels().begin(), out.cut.pixels().end(), std::uint8_t{0});
  const auto width = static_cast<std::size_t>(w);
  if (width < 2 * kReach_px || code.cosine.size() <= kMostOrders) return;
  auto& misfit = out.work.misfit;
  misfit.assign(width, kNoJump);
  for (std::size_t v = 0; v < static_cast<std::size_t>(h); ++v) {
    const std::size_t at = v * width;
    code_sums_of_row(phase, noise, code, v, out.work.sums);
    unwrap_sums(flood, code, at, out.work.sums);
    for (std::size_t u = kReach_px; u + kReach_px <= width; ++u) {
      misfit[u] = one_component(flood, at + u - kReach_px, 2 * kReach_px)
                      ? misfit_of_jump(out.work.sums.data(), u, code, cost)
                      : kNoJump;
    }
    for (std::size_t u = kReach_px; u + kReach_px <= width; ++u) {
      if (!(misfit[u] < kNoJump)) continue;
      const auto first = misfit.begin() + static_cast<std::ptrdiff_t>(u - kReach_px);
      const auto best = std::min_element(first, first + 2 * static_cast<std::ptrdiff_t>(kReach_px));
      out.cut[at + u] = best == misfit.begin() + static_cast<std::ptrdiff_t>(u) ? 1 : 0;
    }
  }
}

}  // namespace enamel::algo
