// The rig and surfaces that mode M's decoder is tested with.
#pragma once

#include <string>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/decoded_scene.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

inline const calib::Rig& wide_rig() {
  static const calib::Rig kRig = micro_rig(400, 120);
  return kRig;
}

inline const pipeline::BurstDecoder& decoder() {
  static const pipeline::BurstDecoder kDecoder = pipeline::BurstDecoder::make(wide_rig()).value();
  return kDecoder;
}

inline const Depth kSlant = [](int u, int v) { return 46 + 0.008 * u + 0.004 * v; };
inline const Depth kStairs = [](int u, int v) {
  const int stair = u / 80;
  return 43.0 + 2.0 * stair + (v < 60 ? 0.0 : 1.3);
};

/// What a failing test shows of a burst.
inline std::string figures(const pipeline::DecodedBurst& b) {
  const auto& d = b.diagnostics;
  return std::string(name_of(b.verdict)) + " linked " + std::to_string(d.linked_share) + " direction " +
         std::to_string(d.direction_share) + " code " + std::to_string(d.code_agreement) + " torn " +
         std::to_string(d.torn_share) + " turn " + std::to_string(d.code_turn_rad) + " odd " +
         std::to_string(d.odd_shift_rad) + " wave " + std::to_string(d.wave.strength()) + " valid " +
         std::to_string(b.patch.valid_px);
}

}  // namespace enamel::test
