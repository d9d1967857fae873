#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/crown_scene.hpp"
#include "tests/support/marker_baseline.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::bench {
namespace {

/// The crowns as a surface before the reference rig.
struct CodedScene {
  calib::Rig rig;
  test::SyntheticBurst burst;
  Map<std::uint8_t> lit;
  double fringe_mm;
};

CodedScene render_coded(double noise_dn, calib::PatternMode mode) {
  calib::Rig rig = calib::parse_rig(test::kRigText).value();
  rig.noise->gain_e_per_dn = 1e6;  // no shot noise, so that every pixel has the noise that is asked for
  rig.noise->full_well_e = 255e6;
  rig.noise->read_noise_e = noise_dn * 1e6;
  rig.patterns.mode = mode;
  if (mode == calib::PatternMode::kSingle) rig.patterns.polarity_code.clear();
  rig.patterns.marker_fringe = 17;  // in the middle of the field, half way through the depth range
  const test::CrownBurst crowns = test::render_crowns({});
  const double fringe_mm = test::fringe_jump_mm(rig, 50);
  test::SceneOptions o;
  o.noise = true;
  o.mean_dn = 100, o.modulation_dn = 70;
  o.light = [&](int u, int v) { return crowns.lit(u, v) != 0 ? 1.0 : 0.0; };
  auto burst = test::render(
      rig,
      [&](int u, int v) {
        const double height = (crowns.phase_rad(u, v) - static_cast<double>(crowns.carrier_rad(u, v))) / 6.283185307;
        return 51.5 - fringe_mm * height;
      },
      o);
  return {std::move(rig), std::move(burst), crowns.lit, fringe_mm};
}

Json share_wrong(std::size_t wrong, std::size_t placed, std::size_t lit) {
  return {{"wrong_pct", 100 * static_cast<double>(wrong) / static_cast<double>(std::max<std::size_t>(placed, 1))},
          {"left_out_pct", 100 * static_cast<double>(lit - placed) / static_cast<double>(lit)}};
}

}  // namespace

Json unwrap_with_code(double noise_dn) {
  const CodedScene scene = render_coded(noise_dn, calib::PatternMode::kPolarity);
  const auto decoder = pipeline::BurstDecoder::make(scene.rig).value();
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  std::size_t valid = 0, wrong = 0, lit = 0;
  decoder.decode(scene.burst.frames.view(), workspace, decoded);
  for (std::size_t i = 0; i < scene.lit.size(); ++i) {
    lit += scene.lit[i];
    const auto z = static_cast<double>(decoded.patch.depth_mm[i]);
    if (std::isnan(z)) continue;
    ++valid;
    wrong += std::abs(z - scene.burst.depth_mm[i]) > 0.5 * scene.fringe_mm ? 1U : 0U;
  }
  Json out = share_wrong(wrong, valid, lit);
  out["verdict"] = pipeline::name_of(decoded.verdict);
  return out;
}

Json unwrap_with_marker(double noise_dn) {
  const CodedScene scene = render_coded(noise_dn, calib::PatternMode::kSingle);
  const test::MarkerOrders orders = test::orders_from_marker(scene.rig, scene.burst.frames.view());
  std::size_t placed = 0, wrong = 0, lit = 0;
  for (std::size_t i = 0; i < scene.lit.size(); ++i) {
    lit += scene.lit[i];
    if (orders.order[i] < 0) continue;
    ++placed;
    const double absolute = static_cast<double>(orders.phase_rad[i]) + 2 * std::numbers::pi * orders.order[i] +
                            (orders.phase_rad[i] < 0 ? 2 * std::numbers::pi : 0);
    wrong += std::abs(absolute - scene.burst.phase_rad[i]) > std::numbers::pi ? 1U : 0U;
  }
  Json out = share_wrong(wrong, placed, lit);
  out["components_placed"] = orders.components_placed;
  return out;
}

}  // namespace enamel::bench
