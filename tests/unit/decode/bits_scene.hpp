// The burst whose decoded bits are the same on every machine, and what they are. Shared by the unit test and by the
// program that is cross-compiled for arm64.
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/algo/decode/burst_decoder.hpp"
#include "protocol/base/crc32.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

struct BitHashes {
  std::uint32_t frames = 0, decoded = 0;
};

/// Change only when the decoder's arithmetic or its input changes; set anew then, after both compilers agree.
inline constexpr BitHashes kModeT{792273796, 1503994008}, kModeM{1792794405, 2573234801};

inline BitHashes bit_hashes(const calib::Rig& rig) {
  SceneOptions o;
  o.noise = true;
  o.motion_rad = 0.03;
  o.harmonic = -0.01;
  o.light = [](int u, int v) { return u > 230 && u < 250 ? 0.0 : 0.4 + 0.003 * v; };
  const auto scene = render(
      rig, [](int u, int v) { return (v > 90 && u < 200 ? 46.5 : 49.0) + 0.01 * u - 0.006 * v; }, o);
  BitHashes out;
  for (const auto& f : scene.frames.frames) out.frames = crc32(std::as_bytes(std::span(f)), out.frames);

  const algo::DecodedBurst b = algo::BurstDecoder::make(rig).value().decode(scene.frames.view());
  if (!b.accepted()) return out;
  const auto add = [&](const auto& map) { out.decoded = crc32(std::as_bytes(map.pixels()), out.decoded); };
  add(b.patch.depth_mm);
  add(b.patch.sigma_mm);
  add(b.patch.points);
  add(b.patch.normals);
  add(b.patch.modulation_dn);
  add(b.phase_rad);
  add(b.order);
  add(b.reject);
  return out;
}

}  // namespace enamel::test
