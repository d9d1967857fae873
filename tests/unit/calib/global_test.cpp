// Step 3 on rigs of the tests' own making: what planes and the correction field add, and what a bow of the field of
// view does to an arch.
#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/judge/judgement.hpp"
#include "calib/judge/step_effect.hpp"
#include "calib/solve/solve.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::calib {
namespace {

constexpr DepthRange kRange{40, 56};
constexpr int kPoses = 12, kHeldOut = 4;

struct Solved {
  test::CalibScene scene;
  std::vector<PoseView> unseen;
  Solution solution;
};

/// Solved on kPoses poses; kHeldOut more only judge. A target known to be flat, so that it cannot take the blame.
Solved solve_scene(std::uint64_t seed, double wave_px, double bow_um, double ground_px = 0.01,
                   ShapeChoice shape = ShapeChoice::kPerfect) {
  Solved s{.scene = test::make_calib_scene(seed, kPoses + kHeldOut), .unseen = {}, .solution = {}};
  s.scene.wave_px = wave_px;
  s.scene.bow_um = bow_um;
  Rng rng(seed, 1, 1);
  auto views = test::make_views(s.scene, {.centre_px = 0.005, .ground_px = ground_px}, rng);
  s.unseen.assign(views.end() - kHeldOut, views.end());
  views.resize(kPoses);
  SolveOptions options;
  options.shape = shape;
  s.solution = solve(std::move(views), s.scene.target, s.scene.nominal, options).value();
  return s;
}

std::vector<StepEffect> effects(const Solved& s) {
  return step_effects(s.solution, s.unseen, s.scene.target, {}, kRange);
}

void expect_no_step_worse(const std::vector<StepEffect>& steps) {
  for (std::size_t k = 1; k < steps.size(); ++k) {
    SCOPED_TRACE(steps[k].step);
    EXPECT_LE(steps[k].plane_rms_um, steps[k - 1].plane_rms_um + steps[k].plane_rms_sigma_um);
    EXPECT_LE(steps[k].sag_um, steps[k - 1].sag_um + std::hypot(steps[k].sag_sigma_um, steps[k - 1].sag_sigma_um));
  }
}

TEST(Steps, none_is_worse_than_the_one_before_and_a_perfect_lens_gets_no_field) {
  for (std::uint64_t seed = 300; seed < 303; ++seed) {
    SCOPED_TRACE(seed);
    const Solved s = solve_scene(seed, 0, 0);
    const auto steps = effects(s);
    ASSERT_EQ(steps.size(), 3U);
    EXPECT_EQ(steps[2].step, "global");
    expect_no_step_worse(steps);
    EXPECT_FALSE(s.solution.state.correction);
  }
}

TEST(Steps, field_earns_its_place_where_the_projector_is_no_lens) {
  for (std::uint64_t seed = 310; seed < 312; ++seed) {
    SCOPED_TRACE(seed);
    const Solved s = solve_scene(seed, 0.03, 0);
    const auto steps = effects(s);
    ASSERT_EQ(steps.size(), 4U) << "no field was taken";
    expect_no_step_worse(steps);
    EXPECT_LT(steps[3].plane_rms_um, steps[2].plane_rms_um - steps[2].plane_rms_sigma_um)
        << "poses without a part in it";
    const FieldTrial& trial = s.solution.field.trials[s.solution.field.taken];
    EXPECT_GT(trial.gain, 3 * trial.gain_sigma);
    EXPECT_LT(test::rig_error(s.solution.steps[3].state, s.scene).p95_um,
              test::rig_error(s.solution.steps[2].state, s.scene).p95_um);
  }
}

TEST(Steps, lens_that_is_none_does_not_pass_for_a_bent_target) {
  const Solved s = solve_scene(310, 0.03, 0, 0.01, ShapeChoice::kAuto);
  EXPECT_FALSE(s.solution.is_shape_solved);
  EXPECT_TRUE(s.solution.state.correction);
}

TEST(Steps, bent_target_does_not_pass_for_a_lens_that_is_none) {
  auto scene = test::make_calib_scene(350, kPoses);
  Rng rng(350, 1, 1);
  test::deform_target(scene, 0.003, 0.020, rng);
  const auto solved =
      solve(test::make_views(scene, {.centre_px = 0.005, .ground_px = 0.01}, rng), scene.target, scene.nominal, {});
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_TRUE(solved->is_shape_solved);
  EXPECT_LT(test::rig_error(solved->state, scene).without_scale_p95_um, 1.5);
}

TEST(Steps, same_pictures_twice_are_one_pose) {
  auto scene = test::make_calib_scene(320, 6);
  Rng rng(320, 1, 1);
  auto views = test::make_views(scene, {.centre_px = 0.005}, rng);
  const std::size_t poses = views.size();
  for (std::size_t j = 0; j < poses; ++j) {
    views.push_back(views[j]);
    views.back().name = "copy of " + views[j].name;
  }
  const auto solved = solve(views, scene.target, scene.nominal, {});
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_EQ(solved->poses.size(), poses);
  ASSERT_EQ(solved->rejected.size(), poses);
  EXPECT_THAT(solved->rejected[0].reason, testing::HasSubstr("same pictures as pose 0"));
  EXPECT_FALSE(solved->is_shape_solved);
}

TEST(Judgement, uneven_planes_count_only_beyond_their_pixels_noise) {
  const Solved s = solve_scene(340, 0, 0);
  const auto says_uneven = [&](double rms_um, double noise_um) {
    PlaneCheck plane{.pose = "0",
                     .points = 2000,
                     .depth_mm = 48,
                     .rms_um = rms_um,
                     .noise_um = noise_um,
                     .shape = {},
                     .sigma = {},
                     .heights = {}};
    plane.sigma = {1, 1, 1};
    const Judgement j = judge(s.solution, {plane}, true, kRange);
    return std::any_of(j.reasons.begin(), j.reasons.end(),
                       [](const std::string& r) { return r.find("uneven beyond") != std::string::npos; });
  };
  EXPECT_FALSE(says_uneven(6.7, 6.7)) << "a good calibration from noisy pictures";
  EXPECT_FALSE(says_uneven(1.9, 1.6));
  EXPECT_TRUE(says_uneven(6.7, 5.5)) << "noise is no excuse for what it does not explain";
  EXPECT_TRUE(says_uneven(4, 1.6));
}

// Drift law -----------------------------------------------------------------------------------------------------------

Pose rigid(const std::vector<Vec3d>& from, const std::vector<Vec3d>& to) {
  Eigen::Matrix3Xd a(3, from.size()), b(3, to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    a.col(static_cast<Eigen::Index>(i)) = from[i];
    b.col(static_cast<Eigen::Index>(i)) = to[i];
  }
  return Pose(Eigen::umeyama(a, b, false));
}

/// A flat strip 55 mm long, seen by a probe that moves along it in steps of 2 mm, each view laid on the one before
/// where both see it. Height of the far end over the plane that the first view gives its middle, um: 4 s (chord / 16
/// mm)² for a bow s (docs/calibration.md §6).
double bend_of_an_arch_um(const RigState& rig, const test::CalibScene& scene) {
  constexpr double kDepth_mm = 48, kHalf_mm = 8, kStep_mm = 2, kChord_mm = 55;
  std::vector<Vec3d> place, seen;
  for (double y = -3; y <= 3; y += 1)
    for (double x = -kHalf_mm; x <= kHalf_mm; x += 1) {
      place.emplace_back(x, y, kDepth_mm);
      seen.push_back(test::measured_place(rig, scene, place.back()));
    }
  const auto pick = [&](auto keep) {
    std::vector<Vec3d> out;
    for (std::size_t i = 0; i < place.size(); ++i)
      if (keep(place[i].x())) out.push_back(seen[i]);
    return out;
  };
  // What this view sees of the strip right of -8 + 2 mm, the next one sees 2 mm further left.
  const auto here = pick([&](double x) { return x > -kHalf_mm + kStep_mm - 0.5; });
  const auto next = pick([&](double x) { return x < kHalf_mm - kStep_mm + 0.5; });
  const Pose step = rigid(next, here);
  const auto near_middle = [](double x) { return std::abs(x) < 2.5; };
  std::vector<Vec3d> middle;
  for (const Vec3d& p : place)
    if (near_middle(p.x())) middle.push_back(p);
  Pose to_truth = rigid(pick(near_middle), middle);
  double travelled_mm = 0;
  for (; travelled_mm + kHalf_mm < kChord_mm - 1e-9; travelled_mm += kStep_mm) to_truth = to_truth * step;
  const Vec3d end = to_truth * test::measured_place(rig, scene, {kChord_mm - travelled_mm, 0, kDepth_mm});
  return 1e3 * (end.z() - kDepth_mm);
}

TEST(Drift, one_micrometre_of_bow_bends_an_arch_by_forty) {
  auto scene = test::make_calib_scene(330, 1);
  EXPECT_NEAR(bend_of_an_arch_um(scene.truth, scene), 0, 1e-3) << "nothing bends without a bow";
  scene.bow_um = 1;
  const double bend_um = std::abs(bend_of_an_arch_um(scene.truth, scene));
  RecordProperty("bend_um", std::to_string(bend_um));
  EXPECT_GT(bend_um, 41);
  EXPECT_LT(bend_um, 48);
}

TEST(Drift, step_3_takes_the_bend_off) {
  std::vector<double> bundled, corrected;
  for (std::uint64_t seed = 330; seed < 333; ++seed) {
    const Solved s = solve_scene(seed, 0, 1, 0.003);
    const auto& steps = s.solution.steps;
    ASSERT_EQ(steps.back().name, "field");
    bundled.push_back(std::abs(bend_of_an_arch_um(steps[1].state, s.scene)));
    corrected.push_back(std::abs(bend_of_an_arch_um(steps.back().state, s.scene)));
  }
  std::sort(bundled.begin(), bundled.end());
  std::sort(corrected.begin(), corrected.end());
  RecordProperty("bundled_um", std::to_string(bundled[1]));
  RecordProperty("corrected_um", std::to_string(corrected[1]));
  EXPECT_LT(corrected[1], bundled[1]) << "lenses bend to take a part of the bow, the field takes more";
  EXPECT_LT(corrected[1], 8) << "of 47 um";
}

}  // namespace
}  // namespace enamel::calib
