// For sources whose loops are compiled once per instruction set and chosen at run time (Google Highway), the same bits
// from each: plain float arithmetic that the compiler vectorises, no fused multiply-add, no reassociation. Such a
// source names itself in HWY_TARGET_INCLUDE and includes this before hwy/foreach_target.h.
#pragma once

/// x86-64: its baseline (to Highway EMU128, whose vector types we do not use) and AVX2; wider sets gain little on loops
/// that wait for memory. arm64: its baseline, NEON.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
