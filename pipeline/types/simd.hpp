// For sources whose loops are compiled once per instruction set and chosen at run time (Google Highway), the same bits
// from each: plain float arithmetic that the compiler vectorises, no multiply-add fused but by name, no reassociation.
// Such a source names itself in HWY_TARGET_INCLUDE and includes this before hwy/foreach_target.h.
#pragma once

/// x86-64: its baseline (to Highway EMU128, whose vector types only tests/support/four_step.cpp uses), AVX2 and
/// AVX-512. arm64: its baseline, NEON. A source whose loops fill arrays of structs defines ENAMEL_NO_AVX512 first:
/// compilers make twice the shuffles of it there.
#define ENAMEL_DISABLED_TARGETS (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#ifdef ENAMEL_NO_AVX512
#define HWY_DISABLED_TARGETS (ENAMEL_DISABLED_TARGETS | HWY_AVX3)
#else
#define HWY_DISABLED_TARGETS ENAMEL_DISABLED_TARGETS
#endif
