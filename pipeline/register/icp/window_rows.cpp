#include "pipeline/register/icp/window_rows.hpp"

#include "pipeline/types/loops.hpp"
#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/register/icp/window_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

void shifted_loop(const float* from, std::size_t step, std::size_t terms, std::size_t count, float* to) {
  const float* __restrict in = from;
  float* __restrict out = to;
  ENAMEL_INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) out[i] = 0.0F + in[i];
  for (std::size_t k = 1; k < terms; ++k) {
    in += step;
    ENAMEL_INDEPENDENT
    for (std::size_t i = 0; i < count; ++i) out[i] += in[i];
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(shifted_loop);

void sum_shifted(const float* in, std::size_t step, std::size_t terms, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(shifted_loop)(in, step, terms, count, out);
}

}  // namespace enamel::pipeline
#endif
