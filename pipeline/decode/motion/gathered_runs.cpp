#include "pipeline/decode/motion/gathered_runs.hpp"

#include <cstring>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/motion/gathered_runs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

/// A vector type of g++ and clang: left to themselves, they gather value by value.
using Run [[gnu::vector_size(4 * kGatheredRun)]] = float;

void gather_loop(const float* row, const GatheredRuns& runs, float* gathered) {
  static_assert(kGatheredRun == 4 && kSparseStep == 2);
  const float* in = row + runs.first;
  for (std::size_t n = 0; n < runs.count; ++n, in += runs.pitch) {
    Run low, high;
    std::memcpy(&low, in, sizeof low);
    std::memcpy(&high, in + kGatheredRun, sizeof high);
    const Run even = __builtin_shufflevector(low, high, 0, 2, 4, 6);
    std::memcpy(gathered + n * kGatheredRun, &even, sizeof even);
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(gather_loop);

void gather_row(const float* row, const GatheredRuns& runs, float* out) {
  HWY_DYNAMIC_DISPATCH(gather_loop)(row, runs, out);
}

void gather_open(const PixelReject* reject, const GatheredRuns& runs, float* out) {
  const PixelReject* run = reject + runs.first;
  for (std::size_t n = 0; n < runs.count; ++n, run += runs.pitch, out += kGatheredRun) {
    for (std::size_t k = 0; k < kGatheredRun; ++k) out[k] = select(run[k * kSparseStep] == PixelReject::kNone, 1, 0);
  }
}

}  // namespace enamel::pipeline
#endif
