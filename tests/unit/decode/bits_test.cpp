// The same burst gives the same bits from every compiler, at every optimisation level, on every instruction set.
#include <gtest/gtest.h>

#include "pipeline/types/simd.hpp"
// simd.hpp says for which sets the decoder is compiled.
#include <hwy/highway.h>

#include <span>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "protocol/base/crc32.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::algo {
namespace {

/// Changes only when the decoder's arithmetic or its input changes; set it anew then, after both compilers agree.
struct Hashes {
  std::uint32_t frames = 0, decoded = 0;
};
constexpr Hashes kModeT{792273796, 3396956344}, kModeM{1792794405, 4121219479};

template <class T>
std::uint32_t add(const Map<T>& m, std::uint32_t crc) {
  return enamel::crc32(std::as_bytes(m.pixels()), crc);
}

void expect_bits(const calib::Rig& rig, const Hashes& expected) {
  test::SceneOptions o;
  o.noise = true;
  o.motion_rad = 0.03;
  o.harmonic = -0.01;
  o.light = [](int u, int v) { return u > 230 && u < 250 ? 0.0 : 0.4 + 0.003 * v; };
  const auto scene = test::render(
      rig, [](int u, int v) { return (v > 90 && u < 200 ? 46.5 : 49.0) + 0.01 * u - 0.006 * v; }, o);
  std::uint32_t frames = 0;
  for (const auto& f : scene.frames.frames) frames = enamel::crc32(std::as_bytes(std::span(f)), frames);
  EXPECT_EQ(frames, expected.frames) << "the input differs, not the decoder";

  const DecodedBurst b = BurstDecoder::make(rig).value().decode(scene.frames.view());
  ASSERT_TRUE(b.accepted());
  std::uint32_t hash = add(b.patch.depth_mm, 0);
  hash = add(b.patch.sigma_mm, hash);
  hash = add(b.patch.points, hash);
  hash = add(b.patch.normals, hash);
  hash = add(b.patch.modulation_dn, hash);
  hash = add(b.phase_rad, hash);
  hash = add(b.order, hash);
  hash = add(b.reject, hash);
  EXPECT_EQ(hash, expected.decoded);
}

TEST(DecodeBits, are_those_of_every_instruction_set_of_this_machine) {
  const auto targets = hwy::SupportedAndGeneratedTargets();
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    EXPECT_GE(targets.size(), 2U) << "AVX2 is not compiled in";
  }
#endif
  for (const std::int64_t target : targets) {
    hwy::SetSupportedTargetsForTest(target);
    SCOPED_TRACE(hwy::TargetName(target));
    expect_bits(test::cropped_rig(320, 160), kModeT);
    expect_bits(test::micro_rig(320, 160), kModeM);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(DecodeBits, are_those_of_every_other_compiler) { expect_bits(test::cropped_rig(320, 160), kModeT); }

TEST(DecodeBits, of_mode_m_are_those_of_every_other_compiler) { expect_bits(test::micro_rig(320, 160), kModeM); }

}  // namespace
}  // namespace enamel::algo
