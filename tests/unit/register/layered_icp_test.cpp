// The mixed metric with layered stop on plaster molars as two stops of a desktop mount see them.
#include "pipeline/register/icp/layered_icp.hpp"

#include <gtest/gtest.h>

#include "pipeline/register/icp/patch_view.hpp"
#include "tests/support/molar_pairs.hpp"
#include "tests/unit/register/turned_patches.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::uint64_t kStarts = 8;

/// Smooth molars, tooth 6, swing 0: made once.
struct Scene {
  test::MolarTable table{std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/desktop_arch.toml", test::Molars::kSmooth, 5};
  test::MolarPair pair = table.pair(6, 0, 1);
  ViewCamera camera{table.rig().camera};
  Reference reference{view_from_patch(pair.reference, pair.T_jaw_reference, table.rig().camera), {}};
  PatchPyramid pyramid = make_pyramid(pair.patch, LayeredConfig{});

  [[nodiscard]] IcpResult align(const Pose& start, const LayeredConfig& config) const {
    return align_layered(pyramid, reference, camera, start, config);
  }
  [[nodiscard]] Pose start(std::uint64_t seed, double shift_mm = 0.3, double turn_deg = 2) const {
    return test::drawn_start(pair.T_jaw_patch, shift_mm, turn_deg, seed);
  }
  [[nodiscard]] bool found(const IcpResult& r) const {
    return r.converged && test::found_truth(test::pose_error(r.T_model_cam, pair.T_jaw_patch));
  }
};

const Scene& scene() {
  static const Scene instance;
  return instance;
}

/// What a caller would believe.
bool looks_right(const IcpResult& r) {
  return r.converged && r.overlap > 0.3 && r.consistency > 0.9 && r.rms_mm < 0.03;
}

TEST(LayeredIcp, finds_the_truth_from_starts_that_axes_leave) {
  const Scene& s = scene();
  for (std::uint64_t seed = 0; seed < kStarts; ++seed) {
    ASSERT_FALSE(test::found_truth(test::pose_error(s.start(seed), s.pair.T_jaw_patch)));
    const IcpResult r = s.align(s.start(seed), {});
    EXPECT_TRUE(s.found(r)) << seed;
    EXPECT_TRUE(looks_right(r)) << seed;
  }
}

/// The control of lambda = 1 in the last layer: with the point term left in, smooth molars are not found well enough.
TEST(LayeredIcp, the_point_term_is_biased_and_must_not_come_last) {
  const Scene& s = scene();
  LayeredConfig to_the_end;
  to_the_end.layers.back().lambda = 0.7;
  double last = 0, plain = 0;
  for (std::uint64_t seed = 0; seed < kStarts; ++seed) {
    last += test::pose_error(s.align(s.start(seed), to_the_end).T_model_cam, s.pair.T_jaw_patch).shift_um;
    plain += test::pose_error(s.align(s.start(seed), {}).T_model_cam, s.pair.T_jaw_patch).shift_um;
  }
  EXPECT_GT(last, 3 * plain);
}

TEST(LayeredIcp, from_beyond_the_basin_it_neither_finds_nor_looks_as_if) {
  const Scene& s = scene();
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const IcpResult r = s.align(s.start(seed, 6, 90), {});
    EXPECT_FALSE(s.found(r)) << seed;
    EXPECT_FALSE(looks_right(r)) << seed << ' ' << r.overlap << ' ' << r.consistency << ' ' << r.rms_mm;
  }
}

TEST(LayeredIcp, another_surface_does_not_look_right) {
  const Scene& s = scene();
  const PatchPyramid mirrored = make_pyramid(::enamel::testing::mirrored(s.pair.patch), LayeredConfig{});
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    const IcpResult r = align_layered(mirrored, s.reference, s.camera, s.start(seed), {});
    EXPECT_FALSE(looks_right(r)) << seed << ' ' << r.overlap << ' ' << r.consistency << ' ' << r.rms_mm;
  }
}

TEST(LayeredIcp, same_arguments_same_bits) {
  const Scene& s = scene();
  const IcpResult a = s.align(s.start(1), {}), b = s.align(s.start(1), {});
  EXPECT_EQ(a.T_model_cam.matrix(), b.T_model_cam.matrix());
  EXPECT_EQ(a.rms_mm, b.rms_mm);
}

TEST(LayeredIcp, layers_end_by_their_own_stop) {
  const Scene& s = scene();
  LayeredConfig patient, endless;
  for (MixedLayer& layer : patient.layers) layer.max_iterations = 400;
  const IcpResult stopped = s.align(s.start(2), patient);
  EXPECT_TRUE(s.found(stopped));
  EXPECT_LT(stopped.iterations, 400);
  endless.rms_change = endless.end_translation_mm = 0;
  int all = 0;
  for (const MixedLayer& layer : endless.layers) all += layer.max_iterations;
  EXPECT_EQ(s.align(s.start(2), endless).iterations, all);
}

TEST(LayeredIcp, too_few_matches_and_empty_references_are_told) {
  const Scene& s = scene();
  const Pose away = Pose(Eigen::Translation3d(0, 0, 30)) * s.pair.T_jaw_patch;
  EXPECT_FALSE(s.align(away, {}).converged);
  const IcpResult none = align_layered(s.pyramid, Reference{}, s.camera, away, {});
  EXPECT_FALSE(none.converged);
  EXPECT_EQ(none.T_model_cam.matrix(), away.matrix());
}

}  // namespace
}  // namespace enamel::pipeline
