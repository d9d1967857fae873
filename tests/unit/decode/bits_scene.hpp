// The burst whose decoded bits are the same on every machine, and what they are. Shared by the unit test and by the
// program that is cross-compiled for arm64.
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/decode/burst_decoder.hpp"
#include "protocol/base/crc32.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

struct BitHashes {
  std::uint32_t frames = 0, decoded = 0;
};

/// Change only when the decoder's arithmetic or its input changes; set anew then, after both compilers agree.
inline constexpr BitHashes kModeT{2218426012, 2760246658}, kModeM{1089105414, 2366870294};

/// Two planes that come nearer while the edge between them passes, a shadow, and a spot that saturates single frames.
inline FrameSet bits_burst(const calib::Rig& rig) {
  SceneOptions o;
  o.noise = true;
  o.harmonic = -0.01;
  o.light = [](int u, int v) {
    if (u > 230 && u < 250) return 0.0;
    return u > 40 && u < 80 && v > 20 && v < 60 ? 1.345 : 0.4 + 0.003 * v;
  };
  return frames_in_motion([&](double tau) {
    const auto depth = [tau](int u, int v) {
      return (v > 90 && u < 200 + 2 * tau ? 46.5 : 49.0) + 0.01 * u - 0.006 * v + 0.017 * tau;
    };
    return render(rig, depth, o);
  });
}

inline BitHashes bit_hashes(const calib::Rig& rig, const pipeline::DecodeConfig& config = {}) {
  const FrameSet frames = bits_burst(rig);
  BitHashes out;
  for (const auto& f : frames.frames) out.frames = crc32(std::as_bytes(std::span(f)), out.frames);

  const pipeline::DecodedBurst b = pipeline::BurstDecoder::make(rig, config).value().decode(frames.view());
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
