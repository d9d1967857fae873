// Light inside teeth: the twin's lobes against photon Monte Carlo and against the table of the design (algorithms §11).
#include "tests/unit/twin/slab_photons.hpp"
#include "tests/unit/twin/slab_scene.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary

// Of enamel in blue light, no light of the surface. Its parameters are guessed to a factor of two.
constexpr std::array<double, 4> kTableMtf{0.64, 0.34, 0.155, 0.076};
constexpr std::array<double, 4> kTableDepthMm{0.150, 0.131, 0.106, 0.075};

TEST(SlabPhotons, reproduce_the_table_of_enamel) {
  // Scattering of 16 / mm is the round number nearest to the table's transfer function. Its depths then come out a
  // quarter less than the table's: they go as 1 / scattering, which is known to a factor of two. Twenty thousand
  // photons scatter by 3 % and 20 um.
  const FringeResponse enamel = SlabPhotons({}, 1).run(20000);
  for (std::size_t k = 0; k < kPeriodsMm.size(); ++k) {
    EXPECT_NEAR(enamel.mtf[k] / kTableMtf[k], 1, 0.12) << kPeriodsMm[k];
    EXPECT_NEAR(enamel.depth_mm[k], kTableDepthMm[k], 0.07) << kPeriodsMm[k];
  }
  // Control: media a factor of two off lie on either side of it.
  Medium clear, dense;
  clear.scatter /= 2;
  dense.scatter *= 2;
  const FringeResponse low = SlabPhotons(clear, 2).run(5000), high = SlabPhotons(dense, 3).run(5000);
  for (std::size_t k = 0; k < kPeriodsMm.size(); ++k) {
    EXPECT_LT(low.mtf[k], 0.85 * kTableMtf[k]);
    EXPECT_GT(high.mtf[k], 1.1 * kTableMtf[k]);
  }
}

TEST(SlabPhotons, of_dentine_agree_with_the_table) {
  // So strongly forward a phase function leaves the depth to chance at this number of photons.
  const FringeResponse dentine = SlabPhotons({28, 0.93, 0.35, 1.54}, 4).run(15000);
  EXPECT_NEAR(dentine.mtf[2], 0.16, 0.05);
}

/// Modulation relative to plaster and depth below it, through the renderer.
std::pair<double, double> rendered(SceneConfig scene, double period_mm) {
  const calib::Rig rig = rig_with_period(period_mm);
  const Fringe seen = fringe_of(scene, rig);
  scene.look.material = 0;
  const Fringe plaster = fringe_of(scene, rig);
  constexpr double kDeeperMm = 0.02;
  SceneConfig deeper = scene;
  deeper.views[0].distance_mm += kDeeperMm;
  const double per_mm = mean_shift(fringe_of(deeper, rig), plaster) / kDeeperMm;
  return {seen.modulation / plaster.modulation, mean_shift(seen, plaster) / per_mm};
}

TEST(TwinTranslucency, slab_of_enamel_renders_as_the_table_says) {
  const SceneConfig scene = slab_of(MaterialId::kEnamel, 0);
  for (std::size_t k = 0; k < kPeriodsMm.size(); ++k) {
    const auto [mtf, depth] = rendered(scene, kPeriodsMm[k]);
    EXPECT_NEAR(mtf / kTableMtf[k], 1, 0.04) << kPeriodsMm[k];
    EXPECT_NEAR(depth, kTableDepthMm[k], 0.008) << kPeriodsMm[k];
  }
}

TEST(TwinTranslucency, slab_of_dentine_renders_as_the_table_says) {
  const auto [mtf, depth] = rendered(slab_of(MaterialId::kDentine, 0), 1);
  EXPECT_NEAR(mtf, 0.16, 0.015);
  EXPECT_NEAR(depth, 0.150, 0.010);
}

TEST(TwinTranslucency, light_of_the_surface_scales_the_depth) {
  const double share = 0.15;
  const auto [mtf, depth] = rendered(slab_of(MaterialId::kEnamel, share), 1);
  const double inside = (1 - share) * kTableMtf[2];
  EXPECT_NEAR(mtf, share + inside, 0.01);
  EXPECT_NEAR(depth, kTableDepthMm[2] * inside / (share + inside), 0.006);
}

TEST(TwinTranslucency, without_it_a_slab_is_plaster) {
  SceneConfig scene = slab_of(MaterialId::kEnamel, 0);
  scene.effects.translucency = false;
  const auto [mtf, depth] = rendered(scene, 1);
  EXPECT_NEAR(mtf, 1, 1e-5);
  EXPECT_NEAR(depth, 0, 1e-5);
}

TEST(ProjectorBlur, wide_blurs_follow_the_gaussian) {
  calib::Rig rig = probe_rig();
  rig.patterns.mode = calib::PatternMode::kPlain4;
  ProjectorConfig config;
  config.round_levels = false;
  config.gamma = config.lut_gamma = 1;
  const auto levels = calib::pattern_levels(rig);
  const auto modulation = [&](const ProjectorLight& light, double sigma) {
    double worst = 0;
    for (double p = 400; p < 424; p += 0.37) {
      std::array<float, 4> e{};
      for (int k = 0; k < 4; ++k) e[static_cast<std::size_t>(k)] = light.blurred(k, p, sigma * sigma);
      const double m = static_cast<double>(std::hypot(e[3] - e[1], e[0] - e[2]));
      worst = std::max(worst, m);
    }
    return worst;
  };
  const ProjectorLight wide(levels, config, 40, 56, 60), narrow(levels, config, 40, 56);
  const double sharp = modulation(wide, 0.7);
  for (const double sigma : {2.0, 4.0, 6.0, 9.0, 14.0}) {
    const double expected = std::exp(-2 * kPi * kPi * (sigma * sigma - 0.49) / 576.0);
    EXPECT_NEAR(modulation(wide, sigma) / sharp, expected, 2e-3) << sigma;
  }
  EXPECT_GT(modulation(narrow, 14) / sharp, 0.3);  // control: tables of defocus alone do not reach so far
}

}  // namespace
}  // namespace enamel::twin
