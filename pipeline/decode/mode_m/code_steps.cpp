#include "pipeline/decode/mode_m/code_steps.hpp"

#include <algorithm>

#include "pipeline/decode/mode_m/code_sum_rows.hpp"
#include "pipeline/decode/unwrap/byte_runs.hpp"

namespace enamel::pipeline {
namespace {

/// Of the pixels that are looked at for the border left of pixel i.
bool one_component(const std::int32_t* component, std::size_t i) {
  const std::int32_t* first = component + i - kStepReach_px;
  std::uint32_t differs = 0;
  for (std::size_t k = 1; k < 2 * kStepReach_px; ++k) differs |= static_cast<std::uint32_t>(first[k] ^ first[0]);
  return differs == 0 && first[0] >= 0;
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

/// Fills the misfits of a row's borders that hide a jump; false: none does.
bool find_jumps(const FloodMaps& flood, std::size_t at, const MicroCode& code, float cost, CodeSteps::Work& work) {
  const std::size_t width = work.misfit.size();
  auto& found = work.candidates;
  const std::int32_t* component = &flood.component[at];
  work.columns.clear();
  for (std::size_t u = end_of_run(work.asked.data(), 0, 0); u < width; u = end_of_run(work.asked.data(), u + 1, 0)) {
    if (one_component(component, u)) work.columns.push_back(u);
  }
  if (work.columns.empty()) return false;
  found.resize(work.columns.size());
  const CodeSumRow& windows = work.windows.sums;
  const auto bring = [&](const std::vector<float>& from, std::vector<float>& left, std::vector<float>& right) {
    const float* source = from.data();
    float *to_left = left.data(), *to_right = right.data();
    const std::size_t* column = work.columns.data();
    const std::size_t count = work.columns.size();
    for (std::size_t k = 0; k < count; ++k) {
      to_left[k] = source[column[k] - kStepReach_px];
      to_right[k] = source[column[k] + kStepGap_px];
    }
  };
  bring(windows.xx, found.left.xx, found.right.xx), bring(windows.xy, found.left.xy, found.right.xy);
  bring(windows.yy, found.left.yy, found.right.yy), bring(windows.xd, found.left.xd, found.right.xd);
  bring(windows.yd, found.left.yd, found.right.yd), bring(windows.dd, found.left.dd, found.right.dd);
  find_misfits(code, cost, found);
  bool jumps = false;
  for (std::size_t k = 0; k < work.columns.size(); ++k) {
    work.misfit[work.columns[k]] = found.misfit[k];
    jumps = jumps || found.misfit[k] < kNoJump;
  }
  return jumps;
}

}  // namespace

void find_code_steps(const PhaseMaps& phase, const NoiseModel& noise, const MicroCode& code, const FloodMaps& flood,
                     float cost, CodeSteps& out) {
  const int w = phase.phase_rad.width(), h = phase.phase_rad.height();
  if (out.cut.width() != w || out.cut.height() != h) out.cut = Map<std::uint8_t>(w, h);
  std::fill(out.cut.pixels().begin(), out.cut.pixels().end(), std::uint8_t{0});
  const auto width = static_cast<std::size_t>(w);
  if (width < 2 * kStepReach_px || code.cosine.size() <= kMostJump) return;
  auto& work = out.work;
  work.misfit.assign(width, kNoJump);
  work.asked.assign(width + kRunPadding, 1);  // what follows a row ends every run
  for (std::size_t v = 0; v < static_cast<std::size_t>(h); ++v) {
    const std::size_t at = v * width;
    unwrapped_sums_of_row(phase, noise, code, &flood.wraps[at], v, work.sums);
    step_windows_row(work.sums, &flood.component[at], cost, work.windows, work.asked.data());
    if (!find_jumps(flood, at, code, cost, work)) continue;
    mark_best(work.misfit, &out.cut[at]);
    std::fill(work.misfit.begin(), work.misfit.end(), kNoJump);
  }
}

}  // namespace enamel::pipeline
