#include "pipeline/decode/mode_m/code_steps.hpp"

#include <algorithm>

#include "pipeline/decode/mode_m/code_sum_rows.hpp"
#include "pipeline/decode/unwrap/byte_runs.hpp"

namespace enamel::pipeline {
namespace {

/// derived: half of the code ratio of 7, rounded down: a jump of more orders looks like one of these.
constexpr int kMostOrders = 3;
constexpr float kNoJump = 1e30F;  ///< layout: above any misfit

/// Half the squares that a jump at the border left of u leaves unexplained; kNoJump unless the jump is a better
/// explanation than none by `cost`.
float misfit_of_jump(const CodeSumRow& windows, std::size_t u, const MicroCode& code, float cost) {
  const CodeSums left = windows.at(u - kStepReach_px), right = windows.at(u + kStepGap_px);
  const float same = explained(left + right);
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

/// The border that fits best among those around.
void mark_best(const std::vector<float>& misfit, std::uint8_t* cut) {
  for (std::size_t u = kStepReach_px; u + kStepReach_px <= misfit.size(); ++u) {
    if (!(misfit[u] < kNoJump)) continue;
    const auto first = misfit.begin() + static_cast<std::ptrdiff_t>(u - kStepReach_px);
    const auto best = std::min_element(first, first + 2 * static_cast<std::ptrdiff_t>(kStepReach_px));
    cut[u] = best == misfit.begin() + static_cast<std::ptrdiff_t>(u) ? 1 : 0;
  }
}

}  // namespace

void find_code_steps(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, const FloodMaps& flood,
                     float cost, CodeSteps& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  if (out.cut.width() != w || out.cut.height() != h) out.cut = Map<std::uint8_t>(w, h);
  std::fill(out.cut.pixels().begin(), out.cut.pixels().end(), std::uint8_t{0});
  const auto width = static_cast<std::size_t>(w);
  if (width < 2 * kStepReach_px || code.cosine.size() <= kMostOrders) return;
  const TurnTable table(code);
  auto& work = out.work;
  work.misfit.assign(width, kNoJump);
  work.asked.assign(width + kRunPadding, 1);  // what follows a row ends every run
  for (std::size_t v = 0; v < static_cast<std::size_t>(h); ++v) {
    const std::size_t at = v * width;
    code_sums_of_row(phase, noise, code, v, work.sums);
    unwrap_sums_row(&flood.wraps[at], &flood.component[at], table, work.sums);
    step_windows_row(work.sums, &flood.component[at], cost, work.windows, work.asked.data());
    bool jumps = false;
    for (std::size_t u = end_of_run(work.asked.data(), 0, 0); u < width; u = end_of_run(work.asked.data(), u + 1, 0)) {
      if (!one_component(flood, at + u - kStepReach_px, 2 * kStepReach_px)) continue;
      work.misfit[u] = misfit_of_jump(work.windows, u, code, cost);
      jumps = jumps || work.misfit[u] < kNoJump;
    }
    if (!jumps) continue;
    mark_best(work.misfit, &out.cut[at]);
    std::fill(work.misfit.begin(), work.misfit.end(), kNoJump);
  }
}

}  // namespace enamel::pipeline
