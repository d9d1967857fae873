// Four frames to phase and modulation: ours (with sigma, mean and mask; and without), OpenCV's subtract + cartToPolar,
// and copying as many bytes. One thread; 640x480, 8 bit; one burst, which stays in the cache, and 32, which do not.
#include <benchmark/benchmark.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/decode/phase/phase.hpp"
#include "tests/support/crown_scene.hpp"
#include "tests/support/four_step.hpp"

namespace {

const enamel::test::CrownBurst& burst() {
  static const enamel::test::CrownBurst kBurst = enamel::test::render_crowns({});
  return kBurst;
}

constexpr double kPixels = 640.0 * 480.0;
constexpr int kManyBursts = 32;  // 118 MB with their maps

void per_pixel(benchmark::State& state) {
  state.counters["ns_per_px"] =
      benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)) * kPixels * 1e-9,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void one_and_many(benchmark::internal::Benchmark* b) {
  b->Arg(1)->Arg(kManyBursts)->ArgName("bursts")->Unit(benchmark::kMillisecond);
}

/// Copies of the burst, each with memory of its own.
std::vector<enamel::test::FrameSet> copies(benchmark::State& state) {
  return std::vector<enamel::test::FrameSet>(static_cast<std::size_t>(state.range(0)), burst().frames);
}

void textbook(benchmark::State& state) {
  const auto frames = copies(state);
  std::vector<enamel::Map<float>> phase(frames.size()), modulation(frames.size());
  for (auto _ : state) {
    for (std::size_t k = 0; k < frames.size(); ++k) enamel::test::four_step(frames[k].view(), phase[k], modulation[k]);
    benchmark::DoNotOptimize(phase.data());
    benchmark::ClobberMemory();
  }
  per_pixel(state);
}

void ours(benchmark::State& state) {
  enamel::pipeline::NoiseModel noise;
  noise.floor_dn2 = 4;
  enamel::pipeline::PhaseMaps maps;
  for (auto _ : state) {
    enamel::pipeline::compute_phase(burst().frames.view(), noise, {}, maps);
    benchmark::DoNotOptimize(maps.phase_rad.pixels().data());
  }
  per_pixel(state);
}

void opencv_cart_to_polar(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto sets = copies(state);
  std::vector<cv::Mat> frames;
  for (const auto& set : sets) {
    for (const auto& f : set.frames)
      frames.emplace_back(480, 640, CV_8UC1, const_cast<std::uint8_t*>(f.data()));  // read only
  }
  cv::Mat s, c;
  std::vector<cv::Mat> phase(sets.size()), modulation(sets.size());
  for (auto _ : state) {
    for (std::size_t k = 0; k < sets.size(); ++k) {
      cv::subtract(frames[4 * k + 3], frames[4 * k + 1], s, cv::noArray(), CV_32F);
      cv::subtract(frames[4 * k], frames[4 * k + 2], c, cv::noArray(), CV_32F);
      cv::cartToPolar(c, s, modulation[k], phase[k]);
    }
    benchmark::DoNotOptimize(phase.data());
    benchmark::ClobberMemory();
  }
  per_pixel(state);
}

/// 4 bytes read and 8 written a pixel: what phase and modulation alone would move.
void copy_phase_and_modulation(benchmark::State& state) {
  std::vector<char> from(static_cast<std::size_t>(kPixels) * 6 * static_cast<std::size_t>(state.range(0)), 1),
      to(from.size());
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  per_pixel(state);
}

/// 4 bytes read and 29 written a pixel: the seven float maps and the mask that ours fills.
void copy_all_our_maps(benchmark::State& state) {
  std::vector<char> from(static_cast<std::size_t>(kPixels) * 33 / 2, 1), to(from.size());
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  per_pixel(state);
}

BENCHMARK(ours)->Arg(1)->ArgName("bursts")->Unit(benchmark::kMillisecond);
BENCHMARK(copy_all_our_maps)->Arg(1)->ArgName("bursts")->Unit(benchmark::kMillisecond);
BENCHMARK(textbook)->Apply(one_and_many);
BENCHMARK(opencv_cart_to_polar)->Apply(one_and_many);
BENCHMARK(copy_phase_and_modulation)->Apply(one_and_many);

}  // namespace

BENCHMARK_MAIN();
