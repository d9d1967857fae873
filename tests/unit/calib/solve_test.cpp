// The solver on dots of known rigs: no images, so that hundreds of rigs can be solved.
#include "calib/solve/solve.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/judge/prediction.hpp"
#include "calib/solve/median.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::calib {
namespace {

constexpr DepthRange kRange{40, 56};

Result<Solution> solve_views(const test::CalibScene& scene, std::vector<PoseView> views,
                             ShapeChoice shape = ShapeChoice::kAuto) {
  SolveOptions options;
  options.shape = shape;
  return solve(std::move(views), scene.target, scene.nominal, options);
}

TEST(Solve, recovers_a_rig_from_noise_free_dots) {
  const auto scene = test::make_calib_scene(1, 10);
  Rng rng(1, 1, 1);
  const auto solved = solve_views(scene, test::make_views(scene, {.centre_px = 1e-7, .projector_px = 1e-6}, rng));
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_LT(test::rig_error(solved->state, scene.truth).max_um, 1e-3);
  EXPECT_NEAR(solved->state.camera.fx, scene.truth.camera.fx, 1e-3);
  EXPECT_FALSE(solved->is_shape_solved);
  EXPECT_TRUE(solved->rejected.empty());
}

TEST(Solve, error_is_what_its_covariance_says) {
  std::vector<double> ratio;
  for (std::uint64_t seed = 10; seed < 21; ++seed) {
    const auto scene = test::make_calib_scene(seed, 10);
    Rng rng(seed, 1, 1);
    const auto solved = solve_views(scene, test::make_views(scene, {.centre_px = 0.005}, rng));
    ASSERT_TRUE(solved) << solved.error().message();
    const double predicted = Prediction(solved->state, solved->result.covariance, kRange, 500).at(0.5).p95_um;
    ratio.push_back(test::rig_error(solved->state, scene.truth).p95_um / predicted);
  }
  EXPECT_LT(median(ratio), 1.2);
  EXPECT_GT(median(ratio), 0.7);
}

/// The fringes of one pose are taken after the target slipped: the dots fit among themselves, the projector does not.
void slip(PoseView& view, double by_px) {
  for (DotView& dot : view.dots) {
    for (ProjectorSample& s : dot.samples) s.projector_px.x() += by_px;
    dot.map.projector_px.x() += by_px;
  }
}

TEST(Solve, thirty_rigs_stay_within_their_own_bound_and_name_the_slipped_pose) {
  constexpr int kRigs = 30;
  int within = 0, named = 0, above_expected = 0;
  for (std::uint64_t seed = 100; seed < 100 + kRigs; ++seed) {
    const auto scene = test::make_calib_scene(seed, 10);
    Rng rng(seed, 1, 1);
    auto views = test::make_views(scene, {.centre_px = 0.005}, rng);
    slip(views[seed % 10], 0.5);
    const auto solved = solve_views(scene, views);
    ASSERT_TRUE(solved) << solved.error().message();
    named += solved->rejected.size() == 1 && solved->rejected[0].pose == std::to_string(seed % 10) ? 1 : 0;
    const Prediction prediction(solved->state, solved->result.covariance, kRange, 1000);
    const double error = test::rig_error(solved->state, scene.truth).p95_um;
    within += error < 1.2 * prediction.at(kBoundQuantile).p95_um ? 1 : 0;
    above_expected += error > prediction.at(0.5).p95_um ? 1 : 0;
  }
  EXPECT_EQ(named, kRigs);
  EXPECT_EQ(within, kRigs);
  // A bound that is kept by being wide would leave few errors above the median that the same covariance expects.
  EXPECT_NEAR(above_expected, 0.5 * kRigs, 3 * 0.5 * std::sqrt(1.0 * kRigs));
}

TEST(Solve, no_pose_is_named_when_none_slipped) {
  for (std::uint64_t seed = 30; seed < 36; ++seed) {
    const auto scene = test::make_calib_scene(seed, 10);
    Rng rng(seed, 1, 1);
    const auto solved = solve_views(scene, test::make_views(scene, {.centre_px = 0.005}, rng));
    ASSERT_TRUE(solved) << solved.error().message();
    EXPECT_TRUE(solved->rejected.empty()) << solved->rejected[0].pose << " " << solved->rejected[0].reason;
  }
}

TEST(Solve, target_that_is_off_its_drawing_is_solved_too) {
  std::vector<double> taken_as_perfect, solved_too;
  for (std::uint64_t seed = 50; seed < 55; ++seed) {
    auto scene = test::make_calib_scene(seed, 20);
    Rng rng(seed, 1, 1);
    test::deform_target(scene, 0.003, 0.020, rng);
    const auto views = test::make_views(scene, {.centre_px = 0.005}, rng);
    const auto automatic = solve_views(scene, views);
    const auto perfect = solve_views(scene, views, ShapeChoice::kPerfect);
    ASSERT_TRUE(automatic && perfect);
    EXPECT_TRUE(automatic->is_shape_solved);
    // The scale hangs on the pitch, which such a target has only on average: not judged.
    solved_too.push_back(test::rig_error(automatic->state, scene.truth).without_scale_p95_um);
    taken_as_perfect.push_back(test::rig_error(perfect->state, scene.truth).without_scale_p95_um);
  }
  EXPECT_LT(median(solved_too), 1.5);
  EXPECT_GT(median(taken_as_perfect), 2 * median(solved_too));
}

TEST(Solve, dot_out_of_place_is_left_out) {
  const auto scene = test::make_calib_scene(3, 10);
  Rng rng(3, 1, 1);
  auto views = test::make_views(scene, {.centre_px = 0.005}, rng);
  views[2].dots[17].ellipse.centre.x() += 0.4;
  const auto solved = solve_views(scene, views);
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_TRUE(solved->poses[2].dots[17].is_outlier);
  EXPECT_FALSE(solved->poses[2].dots[18].is_outlier);
  EXPECT_THAT(solved->notes, testing::Contains(testing::HasSubstr("pose 2: 1 dots left out")));
}

TEST(Solve, same_input_same_bits) {
  const auto scene = test::make_calib_scene(4, 6);
  Rng rng(4, 1, 1);
  const auto views = test::make_views(scene, {}, rng);
  const auto first = solve_views(scene, views), second = solve_views(scene, views);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->state.camera.fx, second->state.camera.fx);
  EXPECT_EQ(first->state.T_proj_cam.matrix(), second->state.T_proj_cam.matrix());
  EXPECT_EQ(first->result.covariance, second->result.covariance);
}

struct Bad {
  const char* name;
  void (*spoil)(test::CalibScene&, std::vector<PoseView>&);
  ErrorCode code;
  const char* says;
};

class BadViews : public testing::TestWithParam<Bad> {};

TEST_P(BadViews, are_refused_with_the_reason) {
  auto scene = test::make_calib_scene(5, 6);
  Rng rng(5, 1, 1);
  auto views = test::make_views(scene, {}, rng);
  ASSERT_TRUE(solve_views(scene, views));
  GetParam().spoil(scene, views);
  const auto solved = solve_views(scene, views);
  ASSERT_FALSE(solved);
  EXPECT_EQ(solved.error().code, GetParam().code) << solved.error().message();
  EXPECT_THAT(solved.error().detail, testing::HasSubstr(GetParam().says));
}

void keep_two(test::CalibScene& /*scene*/, std::vector<PoseView>& views) { views.resize(2); }

void all_parallel(test::CalibScene& scene, std::vector<PoseView>& views) {
  for (std::size_t j = 0; j < scene.truth.T_cam_target.size(); ++j) {
    scene.truth.T_cam_target[j] = scene.truth.T_cam_target[0];
    scene.truth.T_cam_target[j].translation().z() = 46 + static_cast<double>(j);
  }
  Rng rng(6, 1, 1);
  views = test::make_views(scene, {}, rng);
}

void in_metres(test::CalibScene& scene, std::vector<PoseView>& /*views*/) { scene.target.pitch_mm /= 1000; }

void other_pitch(test::CalibScene& scene, std::vector<PoseView>& /*views*/) {
  scene.target.pitch_mm *= 1.15;
  scene.target.radius_mm *= 1.15;
}

void mirrored(test::CalibScene& /*scene*/, std::vector<PoseView>& views) {
  for (PoseView& view : views)
    for (DotView& dot : view.dots) {
      dot.ellipse.centre.x() = 639 - dot.ellipse.centre.x();
      dot.camera_px = dot.ellipse.centre;
      for (ProjectorSample& s : dot.samples) s.camera_px.x() = 639 - s.camera_px.x();
      dot.map = fit_local_map(dot.samples, dot.camera_px).value();
    }
}

INSTANTIATE_TEST_SUITE_P(Sets, BadViews,
                         testing::Values(Bad{"two_poses", keep_two, ErrorCode::kCalibrationPoses, "2 usable poses"},
                                         Bad{"parallel", all_parallel, ErrorCode::kCalibrationPoses, "parallel"},
                                         Bad{"metres", in_metres, ErrorCode::kCalibrationUnits, "pitch_mm"},
                                         Bad{"other_pitch", other_pitch, ErrorCode::kCalibrationUnits, "would fit"},
                                         Bad{"mirrored", mirrored, ErrorCode::kTargetMirrored, "in 6 of 6 poses"}),
                         [](const auto& p) { return std::string(p.param.name); });

}  // namespace
}  // namespace enamel::calib
