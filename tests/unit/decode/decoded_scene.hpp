// What a decoder makes of a synthetic scene, held against the scene's truth.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {

struct DecodedScene {
  std::size_t lit = 0, valid = 0, wrong = 0;  ///< pixels; wrong: beyond kWrongOrder_mm
  double squares_um2 = 0, normalised = 0;     ///< of the error of the others; the same over its sigma
  pipeline::DecodedBurst burst;

  [[nodiscard]] double coverage() const { return static_cast<double>(valid) / static_cast<double>(lit); }
  [[nodiscard]] double wrong_share() const { return static_cast<double>(wrong) / static_cast<double>(valid); }
  [[nodiscard]] double rms_um() const { return std::sqrt(squares_um2 / static_cast<double>(valid - wrong)); }
  [[nodiscard]] double scatter_to_sigma() const { return std::sqrt(normalised / static_cast<double>(valid - wrong)); }
};

inline constexpr double kWrongOrder_mm = 1;  ///< a wrong order is 3.5 mm off

using Depth = std::function<double(int, int)>;  ///< mm, of pixel (u, v)

inline DecodedScene decode_scene(const pipeline::BurstDecoder& decoder, const calib::Rig& rig, const Depth& depth,
                                 const SceneOptions& o) {
  const auto scene = render(rig, depth, o);
  DecodedScene out;
  out.burst = decoder.decode(scene.frames.view());
  for (int v = 0; v < rig.camera.height; ++v) {
    for (int u = 0; u < rig.camera.width; ++u) {
      out.lit += o.light(u, v) > 0 ? 1U : 0U;
      const auto z = static_cast<double>(out.burst.patch.depth_mm(u, v));
      if (std::isnan(z)) continue;
      ++out.valid;
      const double e = z - scene.depth_mm(u, v);
      if (std::abs(e) > kWrongOrder_mm) {
        ++out.wrong;
        continue;
      }
      out.squares_um2 += 1e6 * e * e;
      out.normalised += std::pow(e / static_cast<double>(out.burst.patch.sigma_mm(u, v)), 2);
    }
  }
  return out;
}

}  // namespace enamel::test
