#include "tests/bench/speed/scan_cost.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace enamel::bench {
namespace {

/// A line "VmHWM: 1234 kB" of this process; 0 where there is none.
double status_mib(const std::string& key) {
  std::ifstream in("/proc/self/status");
  for (std::string word; in >> word;) {
    double kb = 0;
    if (word == key + ":" && in >> kb) return kb / 1024;
  }
  return 0;
}

/// From now on VmHWM tells the peak since now.
void forget_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

/// Nearest rank. share in (0, 1]; values not empty.
double percentile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[std::clamp(static_cast<std::size_t>(rank), std::size_t{1}, values.size()) - 1];
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of the last quarter by that of the second: the first one fills keyframes and the model.
double aged(const std::vector<double>& values) {
  const std::size_t quarter = values.size() / 4;
  if (quarter == 0) return 0;
  const auto at = [&](std::size_t n) { return values.begin() + static_cast<std::ptrdiff_t>(n); };
  const double early = percentile({at(quarter), at(2 * quarter)}, 0.99);
  const double late = percentile({at(values.size() - quarter), values.end()}, 0.99);
  return early > 0 ? late / early : 0;
}

}  // namespace

StageCost summarise(const std::vector<std::vector<StepCost>>& repeats) {
  const std::size_t n = repeats.front().size();
  std::vector<double> instructions, ms, blocks, kib;
  for (std::size_t i = 0; i < n; ++i) {
    StepCost least = repeats.front()[i];
    for (const std::vector<StepCost>& costs : repeats) {
      least.instructions = std::min(least.instructions, costs[i].instructions);
      least.core_ms = std::min(least.core_ms, costs[i].core_ms);
    }
    instructions.push_back(static_cast<double>(least.instructions));
    ms.push_back(least.core_ms);
    if (i < n / 2) continue;
    blocks.push_back(static_cast<double>(least.heap.blocks));
    kib.push_back(static_cast<double>(least.heap.bytes) / 1024);
  }
  return {.bursts = n,
          .instructions = mean(instructions),
          .mean_ms = mean(ms),
          .p50_ms = percentile(ms, 0.5),
          .p99_ms = percentile(ms, 0.99),
          .blocks = mean(blocks),
          .kib = mean(kib),
          .ageing = {aged(instructions), aged(ms)}};
}

Result<ScanCost> measure_scan(const Recording& recording, int repeats) {
  constexpr std::size_t kStages = 16;  // more than the graph has
  std::map<std::string, std::vector<std::vector<StepCost>>> costs;
  ScanCost out;
  std::string digest;
  for (int r = 0; r < repeats; ++r) {
    StepMeter meter(kStages * recording.bursts.size());
    forget_peak();
    const double rss_before = status_mib("VmRSS");
    ENAMEL_TRY_ASSIGN(host::ScanResult result, run_scan(recording, 0, &meter));
    if (r == 0) {
      out.rss_before_mib = rss_before;
      out.rss_peak_mib = status_mib("VmHWM");
      digest = result.trace.hash({});
      out.accepted = result.accepted;
      out.fused = result.fused;
      out.rejected = result.rejected;
      out.poses = std::move(result.poses);
    } else if (result.trace.hash({}) != digest) {
      return fail(ErrorCode::kInternal, recording.name + ": two runs of the same bursts differ in their result");
    }
    for (auto& [stage, of_stage] : meter.by_stage()) {
      auto& before_it = costs[stage];
      if (!before_it.empty() && before_it.front().size() != of_stage.size()) {
        return fail(ErrorCode::kInternal, recording.name + ": stage " + stage + " took different bursts in two runs");
      }
      before_it.push_back(std::move(of_stage));
    }
    if (out.counter_problem.empty()) out.counter_problem = meter.counter().problem();
  }
  for (const auto& [stage, of_stage] : costs) out.stages[stage] = summarise(of_stage);
  return out;
}

Result<double> scan_rate(const Recording& recording, int workers, int repeats) {
  double best = 0;
  for (int r = 0; r < repeats; ++r) {
    ENAMEL_TRY_ASSIGN(const host::ScanResult result, run_scan(recording, workers));
    best = std::max(best, static_cast<double>(recording.bursts.size()) / result.seconds);
  }
  return best;
}

}  // namespace enamel::bench
