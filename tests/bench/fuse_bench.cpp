// Time of fusion, view and meshing of a VGA burst: bursts of a bumpy surface that fills the frame, swept sideways.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "pipeline/model/fuse/tsdf_model.hpp"
#include "pipeline/model/mesh/incremental_mesher.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel {
namespace {

struct Sweep {
  calib::Rig rig = synthetic::rig();
  std::vector<SurfacePatch> patches;
  std::vector<Pose> poses;
};

/// Balls of 3.5 mm in a row on a plane: crowns on gingiva, as far as the load goes.
const Sweep& sweep() {
  static const Sweep made = [] {
    Sweep s;
    auto surface = synthetic::plane({0.05, 0.1, -1}, 0.0);
    for (int i = -3; i <= 3; ++i) {
      for (int j = -1; j <= 1; ++j) {
        surface = synthetic::nearest(surface, synthetic::sphere({6.0 * i, 6.0 * j, 0.5}, 3.5));
      }
    }
    for (std::uint64_t k = 0; k < 12; ++k) {
      const auto t = static_cast<double>(k);
      s.poses.push_back(synthetic::looking_at({0.4 * t - 2.0, 0.1 * t, 0.0}, {0.02 * t - 0.1, 0.1, 1}, 48.0, 0.01 * t));
      s.patches.push_back(synthetic::render(s.rig, surface, s.poses.back(), {0.0085, true, k + 1}));
    }
    return s;
  }();
  return made;
}

void integrate(benchmark::State& state) {
  const Sweep& s = sweep();
  pipeline::TsdfModel model(s.rig);
  std::uint64_t k = 0;
  std::uint64_t voxels = 0;
  std::uint64_t blocks = 0;
  for (auto _ : state) {
    const std::size_t i = k % s.patches.size();
    const pipeline::FuseStats stats = model.integrate(BurstId{k}, s.patches[i], s.poses[i]);
    voxels += stats.voxels_updated;
    blocks += stats.blocks_touched;
    ++k;
  }
  state.counters["blocks"] = static_cast<double>(model.grid().size());
  state.counters["blocks_per_burst"] = static_cast<double>(blocks) / static_cast<double>(k);
  state.counters["voxels_per_burst"] = static_cast<double>(voxels) / static_cast<double>(k);
}
BENCHMARK(integrate)->Unit(benchmark::kMillisecond)->Iterations(60);

void prepare_surfels(benchmark::State& state) {
  const Sweep& s = sweep();
  const pipeline::FuseConfig config;
  pipeline::SurfelMap surfels(s.rig, config);
  pipeline::FuseStats stats;
  for (auto _ : state) {
    surfels.build(s.patches[0], config, stats);
    benchmark::DoNotOptimize(surfels[0]);
  }
}
BENCHMARK(prepare_surfels)->Unit(benchmark::kMillisecond)->Iterations(60);

void view(benchmark::State& state) {
  const Sweep& s = sweep();
  pipeline::TsdfModel model(s.rig);
  for (std::size_t i = 0; i < s.patches.size(); ++i) {
    model.integrate(BurstId{i}, s.patches[i], s.poses[i]);
  }
  std::size_t k = 0;
  for (auto _ : state) {
    const std::size_t i = k++ % s.patches.size();
    benchmark::DoNotOptimize(model.view(s.poses[i], s.patches[i]));
  }
}
BENCHMARK(view)->Unit(benchmark::kMillisecond)->Iterations(60);

/// Blocks that moved by 2 um or more, after every burst of a sweep that comes over the same surface again and again.
void mesh_update(benchmark::State& state) {
  const Sweep& s = sweep();
  pipeline::TsdfModel model(s.rig);
  pipeline::IncrementalMesher mesher;
  std::uint64_t k = 0;
  std::uint64_t blocks = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::size_t i = k % s.patches.size();
    model.integrate(BurstId{k}, s.patches[i], s.poses[i]);
    ++k;
    state.ResumeTiming();
    const auto max_blocks = static_cast<std::size_t>(state.range(0));
    blocks += mesher.update(model, model.take_changed(0.002), max_blocks).blocks_meshed;
    benchmark::DoNotOptimize(mesher.snapshot());
  }
  state.counters["blocks_per_burst"] = static_cast<double>(blocks) / static_cast<double>(k);
}
BENCHMARK(mesh_update)->Arg(400)->Arg(1000000)->Unit(benchmark::kMillisecond)->Iterations(60);

void mesh_all_touched(benchmark::State& state) {
  const Sweep& s = sweep();
  pipeline::TsdfModel model(s.rig);
  model.integrate(BurstId{0}, s.patches[0], s.poses[0]);
  model.integrate(BurstId{1}, s.patches[0], s.poses[0]);
  const auto changed = model.take_changed();
  pipeline::IncrementalMesher mesher;
  for (auto _ : state) {
    benchmark::DoNotOptimize(mesher.update(model, changed).blocks_meshed);
  }
  state.counters["blocks"] = static_cast<double>(changed.size());
}
BENCHMARK(mesh_all_touched)->Unit(benchmark::kMillisecond)->Iterations(30);

}  // namespace
}  // namespace enamel

BENCHMARK_MAIN();
