#include "tests/support/draw/ready.hpp"

#include <utility>

namespace enamel::test {
namespace {

/// The same field on few pixels: what a decoder says of the pattern set it says of this one, at once.
calib::Rig coarse(const calib::Rig& rig) {
  constexpr int kCoarser = 20;
  calib::Rig out = rig;
  calib::LensValues& lens = out.camera;
  lens.width /= kCoarser, lens.height /= kCoarser;
  lens.fx /= kCoarser, lens.fy /= kCoarser, lens.cx /= kCoarser, lens.cy /= kCoarser;
  return out;
}

}  // namespace

ReadyDraw ready_draw(std::uint64_t seed, calib::PatternMode mode) {
  constexpr int kTries = 50;
  ReadyDraw out;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    out.drawn = draw(seed, mode, attempt);
    auto decoder = pipeline::BurstDecoder::make(coarse(out.drawn.rig));
    if (decoder) decoder = pipeline::BurstDecoder::make(out.drawn.rig);
    if (decoder) {
      out.decoder = std::move(*decoder);
      return out;
    }
    out.refused.push_back(decoder.error().detail);
  }
  return out;
}

}  // namespace enamel::test
