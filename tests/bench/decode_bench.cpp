// Processor time of one VGA burst, burst 0 of each rendered set, per step, one thread.
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>
#include <string>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/decode/folder_burst.hpp"

namespace {

/// Processor time of this thread: other load on the machine does not count.
double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

void decode_burst(benchmark::State& state, const std::string& set) {
  const std::string folder = enamel::test::shared_folder() + "/data/oracle/" + set;
  const auto rig = enamel::calib::load_rig(folder + "/rig.json");
  const auto frames = enamel::test::load_folder_burst(folder, 0);
  if (!rig || !frames) return state.SkipWithError("no such exchange folder");
  const auto decoder = enamel::algo::BurstDecoder::make(*rig);
  if (!decoder) return state.SkipWithError("rig refused");
  enamel::algo::DecodeWorkspace workspace;
  enamel::algo::DecodedBurst out;
  decoder->decode(frames->view(), workspace, out);  // takes the memory that later bursts find there
  std::map<std::string, double> steps;
  double last = thread_ms();
  workspace.on_step = [&](const char* step) {
    const double now = thread_ms();
    steps[step] += now - last;
    last = now;
  };
  for (auto _ : state) {
    last = thread_ms();
    decoder->decode(frames->view(), workspace, out);
    workspace.on_step("rest");
    benchmark::DoNotOptimize(out.patch.valid_px);
  }
  for (const auto& [step, ms] : steps) state.counters[step] = ms / static_cast<double>(state.iterations());
}

BENCHMARK_CAPTURE(decode_burst, plane, "plane-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, spheres, "spheres-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, steps, "steps-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, sweep, "sweep-01")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
