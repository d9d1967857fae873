#include "pipeline/stages/live_image.hpp"

#include <cstddef>

namespace enamel::stage {
namespace {

// Every burst has one made: written so that a compiler takes many pixels at a time. NaN fails both comparisons.
void to_grey(const float* dn, std::uint8_t* grey, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float lit = dn[i] > 0.0F ? dn[i] : 0.0F;
    const float cut = lit < 255.0F ? lit : 255.0F;
    grey[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(cut));
  }
}

}  // namespace

Map<std::uint8_t> live_image(const Map<float>& texture_dn) {
  Map<std::uint8_t> out(texture_dn.width(), texture_dn.height());
  to_grey(texture_dn.pixels().data(), out.pixels().data(), out.size());
  return out;
}

}  // namespace enamel::stage
