#include "pipeline/decode/triangulate/interleave.hpp"

#include <hwy/cache_control.h>

#include <array>
#include <cstdint>

#include "pipeline/types/simd.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pipeline/decode/triangulate/interleave.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace enamel::pipeline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<float>;

[[gnu::always_inline]] inline void store_triples(const float* x, const float* y, const float* z, float* out) {
  const Lanes d;
  hn::StoreInterleaved3(hn::LoadU(d, x), hn::LoadU(d, y), hn::LoadU(d, z), d, out);
}

// Compilers store such triples lane by lane.
void interleave_loop(const float* x, const float* y, const float* z, std::size_t count, float* out) {
  const Lanes d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  if (reinterpret_cast<std::uintptr_t>(out) % (lanes * sizeof(float)) == 0) {
    // Past the caches: a picture of triples is larger than they are, and who reads it next is another thread.
    HWY_ALIGN std::array<float, 3 * hn::MaxLanes(d)> triples;
    for (; i + lanes <= count; i += lanes) {
      store_triples(x + i, y + i, z + i, triples.data());
      for (std::size_t k = 0; k < 3 * lanes; k += lanes)
        hn::Stream(hn::Load(d, triples.data() + k), d, out + 3 * i + k);
    }
    hwy::FlushStream();
  }
  for (; i + lanes <= count; i += lanes) store_triples(x + i, y + i, z + i, out + 3 * i);
  for (; i < count; ++i) {
    out[3 * i] = x[i];
    out[3 * i + 1] = y[i];
    out[3 * i + 2] = z[i];
  }
}

}  // namespace enamel::pipeline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace enamel::pipeline {

HWY_EXPORT(interleave_loop);

void interleave(const float* x, const float* y, const float* z, std::size_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(interleave_loop)(x, y, z, count, out);
}

}  // namespace enamel::pipeline
#endif
