// Modes T and M side by side: the same teeth, noise, motion and blur through the same decoder.
#include <cmath>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/order_score.hpp"
#include "tests/support/tooth_steps.hpp"

namespace enamel::bench {
namespace {

constexpr int kWidth = 400, kHeight = 300, kScenes = 4;
constexpr double kMean_dn = 110, kModulation_dn = 40;

struct Condition {
  double noise = 0;  ///< sigma of a frame over the modulation that the camera sees
  double motion_rad = 0, blur_fringe = 0;
};

/// Every pixel has the noise that is asked for: read noise alone.
calib::Rig rig_of(calib::PatternMode mode, double noise_dn) {
  calib::Rig rig = mode == calib::PatternMode::kMicro ? test::micro_rig(kWidth, kHeight, test::kShippedRatio)
                                                      : test::cropped_rig(kWidth, kHeight);
  rig.noise->gain_e_per_dn = 1e6;
  rig.noise->full_well_e = 255e6;
  rig.noise->read_noise_e = noise_dn * 1e6;
  return rig;
}

test::OrderCounts measure(const calib::Rig& rig, const pipeline::BurstDecoder& decoder, const Condition& c) {
  test::OrderCounts sum;
  pipeline::DecodeWorkspace workspace;
  pipeline::DecodedBurst decoded;
  for (std::uint64_t scene = 1; scene <= kScenes; ++scene) {
    const test::ToothSteps steps = test::make_tooth_steps(rig, scene);
    test::SceneOptions o = steps.options(scene);
    o.mean_dn = kMean_dn;
    // What the blur takes of the fringes' modulation is made up for, so that noise and blur are two axes, not one.
    o.modulation_dn = kModulation_dn * std::exp(0.5 * std::pow(2 * std::numbers::pi * c.blur_fringe, 2));
    o.motion_rad = c.motion_rad, o.blur_fringe = c.blur_fringe;
    o.light = [&steps](int u, int v) { return steps.light(u, v) > 0 ? 1.0 : 0.0; };
    o.contrast = [](int, int) { return 1.0; };
    const auto burst = test::render(
        rig, [&steps](int u, int v) { return steps.depth_mm(u, v); }, o);
    decoder.decode(burst.frames.view(), workspace, decoded);
    sum += test::score_orders(decoded, burst, steps.light, steps.near_jump);
  }
  return sum;
}

Json counts_json(const test::OrderCounts& c) {
  return {{"bursts", c.bursts},         {"rejected_bursts", c.rejected_bursts},
          {"wrong_pct", c.wrong_pct()}, {"undecided_pct", c.undecided_pct()},
          {"edge_pct", c.edge_pct()},   {"masked_pct", c.masked_pct()},
          {"wrong_px", c.wrong},        {"accepted_px", c.accepted},
          {"rms_um", c.rms_um()},       {"sigma_um", c.sigma_um()}};
}

}  // namespace

Json modes_study() {
  Json rows = Json::array();
  test::OrderCounts total_t, total_m;
  for (const double noise : {0.03, 0.05, 0.1, 0.15}) {
    const auto t = rig_of(calib::PatternMode::kPolarity, noise * kModulation_dn);
    const auto m = rig_of(calib::PatternMode::kMicro, noise * kModulation_dn);
    const auto by_t = pipeline::BurstDecoder::make(t).value(), by_m = pipeline::BurstDecoder::make(m).value();
    for (const double motion : {0.0, 0.1, 0.2}) {
      for (const double blur : {0.0, 0.1, 0.2}) {
        const Condition c{noise, motion, blur};
        const auto counts_t = measure(t, by_t, c), counts_m = measure(m, by_m, c);
        total_t += counts_t, total_m += counts_m;
        rows.push_back({{"noise", noise},
                        {"motion_rad", motion},
                        {"blur_fringe", blur},
                        {"T", counts_json(counts_t)},
                        {"M", counts_json(counts_m)}});
      }
    }
  }
  return {{"rows", rows}, {"T", counts_json(total_t)}, {"M", counts_json(total_m)}};
}

}  // namespace enamel::bench
