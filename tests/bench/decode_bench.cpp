// Processor time of one VGA burst, per step, one thread: burst 0 of each rendered set, and bursts of the twin in both
// pattern modes, rendered before the clock runs.
#include <benchmark/benchmark.h>

#include <ctime>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/bench/thread_time.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/decode/folder_burst.hpp"

#ifdef ENAMEL_WITH_TWIN
#include "tools/twin/twin_source.hpp"
#endif

namespace {

using enamel::bench::thread_ms;

void decode_frames(benchmark::State& state, const enamel::calib::Rig& rig, const enamel::pipeline::BurstView& frames) {
  const auto decoder = enamel::pipeline::BurstDecoder::make(rig);
  if (!decoder) return state.SkipWithError("rig refused");
  enamel::pipeline::DecodeWorkspace workspace;
  enamel::pipeline::DecodedBurst out;
  decoder->decode(frames, workspace, out);  // takes the memory that later bursts find there
  if (!out.accepted()) return state.SkipWithError("burst rejected: the time of a whole decode is asked for");
  std::map<std::string, double> steps;
  double last = thread_ms();
  workspace.on_step = [&](const char* step) {
    const double now = thread_ms();
    steps[step] += now - last;
    last = now;
  };
  for (auto _ : state) {
    last = thread_ms();
    decoder->decode(frames, workspace, out);
    workspace.on_step("rest");
    benchmark::DoNotOptimize(out.patch.valid_px);
  }
  for (const auto& [step, ms] : steps) state.counters[step] = ms / static_cast<double>(state.iterations());
}

void decode_burst(benchmark::State& state, const std::string& set) {
  const std::string folder = enamel::test::shared_folder() + "/data/oracle/" + set;
  const auto rig = enamel::calib::load_rig(folder + "/rig.json");
  const auto frames = enamel::test::load_folder_burst(folder, 0);
  if (!rig || !frames) return state.SkipWithError("no such exchange folder");
  decode_frames(state, *rig, frames->view());
}

BENCHMARK_CAPTURE(decode_burst, plane, "plane-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, spheres, "spheres-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, steps, "steps-01")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_burst, sweep, "sweep-01")->Unit(benchmark::kMillisecond);

#ifdef ENAMEL_WITH_TWIN

struct Rendered {
  enamel::calib::Rig rig;
  enamel::fw::SimBurst burst;
};

/// Burst `number` of a scene of config/scenes before a probe of config/rigs; none: not to be had.
std::optional<Rendered> render(const std::string& scene_name, const std::string& rig_name, int number) {
  const std::string config = ENAMEL_SOURCE_DIR "/config/";
  const auto scene = enamel::twin::load_scene(config + "scenes/" + scene_name);
  auto rig = enamel::calib::load_rig(config + "rigs/" + rig_name);
  if (!scene || !rig) return std::nullopt;
  const auto source = enamel::twin::TwinSource::create(*scene, *rig);
  if (!source) return std::nullopt;
  for (int k = 0;; ++k) {
    auto burst = (*source)->next();
    if (!burst || !*burst) return std::nullopt;
    if (k == number) return Rendered{std::move(*rig), std::move(**burst)};
  }
}

/// The benchmark asks several times for each.
void decode_twin(benchmark::State& state, const std::string& scene, const std::string& rig, int number) {
  static std::map<std::string, std::optional<Rendered>> known;
  const auto [at, fresh] = known.try_emplace(scene + rig);
  if (fresh) at->second = render(scene, rig, number);
  if (!at->second) return state.SkipWithError("cannot be rendered");
  const auto& burst = at->second->burst;
  enamel::pipeline::BurstView view{burst.width, burst.height, burst.bit_depth, {}};
  for (std::size_t k = 0; k < view.frames.size(); ++k) view.frames[k] = burst.frames[k];
  decode_frames(state, at->second->rig, view);
}

constexpr int kSweeping = 4;  ///< by then the probe moves along the arch
BENCHMARK_CAPTURE(decode_twin, plane_T, "plane.toml", "probe_t.json", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_twin, plane_M, "plane.toml", "probe.json", 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_twin, molars_T, "quadrant_small.toml", "probe_t.json", kSweeping)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(decode_twin, molars_M, "quadrant_small.toml", "probe.json", kSweeping)->Unit(benchmark::kMillisecond);

#endif

}  // namespace

BENCHMARK_MAIN();
