#include "pipeline/algo/triangulate/interleave.hpp"

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/algo/triangulate/interleave.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::algo::HWY_NAMESPACE {

// Compilers store such triples lane by lane.
void interleave_loop(const float* x, const float* y, const float* z, std::size_t count, float* out) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    hn::StoreInterleaved3(hn::LoadU(d, x + i), hn::LoadU(d, y + i), hn::LoadU(d, z + i), d, out + 3 * i);
  for (; i < count; ++i) {
    out[3 * i] = x[i];
    out[3 * i + 1] = y[i];
    out[3 * i + 2] = z[i];
  }
}

}  // namespace enamel::algo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::algo {

HWY_EXPORT(interleave_loop);

void interleave(const float* x, const float* y, const float* z, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(interleave_loop)(x, y, z, count, out);
}

}  // namespace enamel::algo
#endif
