// Four frames to phase and modulation: ours (with sigma, mean and mask), OpenCV's subtract + cartToPolar, and copying
// as many bytes. One thread; 640x480, 8 bit.
#include <benchmark/benchmark.h>

#include <cstring>
#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/algo/phase/phase.hpp"
#include "tests/support/crown_scene.hpp"

namespace {

const enamel::test::CrownBurst& burst() {
  static const enamel::test::CrownBurst kBurst = enamel::test::render_crowns({});
  return kBurst;
}

constexpr double kPixels = 640.0 * 480.0;

void per_pixel(benchmark::State& state) {
  state.counters["ns_per_px"] = benchmark::Counter(static_cast<double>(state.iterations()) * kPixels * 1e-9,
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void ours(benchmark::State& state) {
  enamel::algo::NoiseModel noise;
  noise.floor_dn2 = 4;
  enamel::algo::PhaseMaps maps;
  for (auto _ : state) {
    enamel::algo::compute_phase(burst().frames.view(), noise, {}, maps);
    benchmark::DoNotOptimize(maps.phase_rad.pixels().data());
  }
  per_pixel(state);
}

void opencv_cart_to_polar(benchmark::State& state) {
  cv::setNumThreads(1);
  std::vector<cv::Mat> frames;
  for (const auto& f : burst().frames.frames)
    frames.emplace_back(480, 640, CV_8UC1, const_cast<std::uint8_t*>(f.data()));  // read only
  cv::Mat s, c, modulation, phase;
  for (auto _ : state) {
    cv::subtract(frames[3], frames[1], s, cv::noArray(), CV_32F);
    cv::subtract(frames[0], frames[2], c, cv::noArray(), CV_32F);
    cv::cartToPolar(c, s, modulation, phase);
    benchmark::DoNotOptimize(phase.data);
  }
  per_pixel(state);
}

/// 4 bytes read and 8 written a pixel: what phase and modulation alone would move.
void copy_phase_and_modulation(benchmark::State& state) {
  std::vector<char> from(static_cast<std::size_t>(kPixels) * 6, 1), to(from.size());
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

BENCHMARK(ours)->Unit(benchmark::kMillisecond);
BENCHMARK(opencv_cart_to_polar)->Unit(benchmark::kMillisecond);
BENCHMARK(copy_phase_and_modulation)->Unit(benchmark::kMillisecond);
BENCHMARK(copy_all_our_maps)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
