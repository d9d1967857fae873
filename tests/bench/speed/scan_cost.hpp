// What a recording costs, stage by stage: the figures of bench_speed.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/bench/speed/recording.hpp"
#include "tests/bench/speed/step_meter.hpp"

namespace enamel::bench {

/// What a stage takes at the end of a scan beside what it took when the scan had begun.
struct Ageing {
  double instructions = 0, ms = 0;  ///< 99th percentile of the last quarter by that of the second; 0: too few bursts
};

struct StageCost {
  std::size_t bursts = 0;
  double instructions = 0;                     ///< mean a burst; of each burst the least of the repeats
  double mean_ms = 0, p50_ms = 0, p99_ms = 0;  ///< core time; of each burst the least of the repeats
  double blocks = 0, kib = 0;                  ///< heap, mean a burst over the second half of the recording
  Ageing ageing;
};

struct ScanCost {
  std::map<std::string, StageCost> stages;
  std::string counter_problem;  ///< empty: instructions were counted
  std::size_t accepted = 0, fused = 0;
  std::map<std::string, std::uint64_t> rejected;
  double rss_before_mib = 0, rss_peak_mib = 0;  ///< of the program, recording included
  std::vector<host::PlacedPose> poses;
};

/// Runs the recording `repeats` times on one thread. repeats >= 1. Errors: of run_scan; kInternal when two repeats do
/// not give the same result, because then their costs are not to be compared.
[[nodiscard]] Result<ScanCost> measure_scan(const Recording& recording, int repeats);

/// Bursts a second of wall time from the first one in to the last one out, best of `repeats`.
[[nodiscard]] Result<double> scan_rate(const Recording& recording, int workers, int repeats);

/// Of costs of the same bursts in the same order, one list a repeat. Not empty. Pure.
[[nodiscard]] StageCost summarise(const std::vector<std::vector<StepCost>>& repeats);

}  // namespace enamel::bench
