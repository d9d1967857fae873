// From images to a rig: rendered poses of a rig of our own, and the rendered set of another program where it is
// present.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "calib/io/rig_writer.hpp"
#include "calib/judge/judgement.hpp"
#include "calib/judge/prediction.hpp"
#include "calib/model/lens.hpp"
#include "calib/solve/measure_folder.hpp"
#include "protocol/base/file.hpp"
#include "tests/support/calib_scene.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/true_poses.hpp"

namespace enamel::calib {
namespace {

constexpr DepthRange kRange{40, 56};

TEST(Images, six_rendered_poses_give_the_rig) {
  const auto scene = test::make_calib_scene(77, 6);
  Rng rng(77, 2, 1);
  const test::SensorModel sensor;
  std::vector<PoseView> views;
  for (std::size_t j = 0; j < scene.truth.T_cam_target.size(); ++j) {
    auto view = measure_pose(test::render_pose(scene, j, sensor, rng), scene.target, test::noise_of(sensor), 255,
                             {854, 480}, EdgeModel::kPixelThenTaps);
    ASSERT_TRUE(view) << view.error().message();
    EXPECT_EQ(view->dots.size(), 63U);
    views.push_back(std::move(*view));
  }
  SolveOptions options;
  options.fringe_period_px = {854.0 / 64, 480.0 / 64};
  const auto solved = solve(views, scene.target, scene.nominal, options);
  ASSERT_TRUE(solved) << solved.error().message();
  const double predicted = Prediction(solved->state, solved->result.covariance, kRange).at(0.5).p95_um;
  EXPECT_LT(test::rig_error(solved->state, scene.truth).p95_um, 3 * predicted);
  EXPECT_LT(predicted, 0.5);
  EXPECT_LT(solved->result.rms_camera_px, 0.01);
}

class BadFrames : public testing::Test {
 protected:
  PoseFrames render(const test::SensorModel& sensor) {
    Rng rng(5, 2, 1);
    return test::render_pose(scene_, 0, sensor, rng);
  }
  Result<PoseView> measured(const PoseFrames& frames) {
    return measure_pose(frames, scene_.target, test::noise_of({}), 255, {854, 480}, EdgeModel::kPixelThenTaps);
  }
  test::CalibScene scene_ = test::make_calib_scene(5, 1);
};

TEST_F(BadFrames, blurred_pose_is_named) {
  EXPECT_TRUE(measured(render({})));
  const auto view = measured(render({.blur_px = 2.2}));
  ASSERT_FALSE(view);
  EXPECT_THAT(view.error().detail, testing::HasSubstr("blurred"));
}

TEST_F(BadFrames, saturated_pose_is_named) {
  PoseFrames frames = render({});
  for (float& p : frames.white.pixels()) p = std::min(255.0F, 2.2F * p);
  const auto view = measured(frames);
  ASSERT_FALSE(view);
  EXPECT_THAT(view.error().detail, testing::HasSubstr("saturated"));
}

TEST_F(BadFrames, fringes_that_were_not_projected_are_named) {
  PoseFrames frames = render({});
  for (FringeLevel& level : frames.along_v)
    for (auto& frame : level.frames) frame = frames.black;
  const auto view = measured(frames);
  ASSERT_FALSE(view);
  EXPECT_EQ(view.error().code, ErrorCode::kCalibrationPoses);
  EXPECT_THAT(view.error().detail, testing::HasSubstr("0 of 63 dots"));
}

TEST(RigWriter, text_reads_back_and_guards_itself) {
  const auto scene = test::make_calib_scene(1, 1);
  Rig nominal;
  nominal.text = R"({"format": "rig/1", "units": "mm", "nominal": true, "serial": "EN-7", "note": [1, 2],
    "camera": {}, "projector": {}, "T_proj_cam": [],
    "patterns": {"mode": "multi", "cycles": [1, 4, 16, 64], "steps": 4}})";
  SolvedRig solved{.camera = scene.truth.camera,
                   .projector = scene.truth.projector,
                   .T_proj_cam = scene.truth.T_proj_cam,
                   .parameter_names = {"camera.fx"},
                   .covariance = Eigen::MatrixXd::Identity(1, 1),
                   .calibrated_at = "2026-01-31T12:00:00Z",
                   .response = {},
                   .correction = CorrectionField{.u_px = {10, 600},
                                                 .v_px = {20, 450},
                                                 .inverse_mm = {0.018, 0.024},
                                                 .terms = {2, 1, 2},
                                                 .coefficients = {1e-7, -2e-7, 3e-7, 4e-8}}};
  const auto text = solved_rig_text(nominal, solved);
  ASSERT_TRUE(text) << text.error().message();
  const Rig back = parse_rig(*text).value();
  EXPECT_EQ(back.camera.fx, scene.truth.camera.fx);
  EXPECT_EQ(back.projector.dist, scene.truth.projector.dist);
  EXPECT_EQ(back.T_proj_cam[0][3], scene.truth.T_proj_cam.matrix()(0, 3));
  EXPECT_EQ(back.serial, "EN-7");
  ASSERT_TRUE(back.correction);
  EXPECT_EQ(back.correction->terms, solved.correction->terms);
  EXPECT_EQ(back.correction->inverse_mm, solved.correction->inverse_mm);
  EXPECT_EQ(back.correction->coefficients, solved.correction->coefficients);
  EXPECT_THAT(*text, testing::HasSubstr("\"note\""));
  EXPECT_THAT(*text, testing::Not(testing::HasSubstr("\"nominal\"")));
  EXPECT_TRUE(is_rig_intact(*text));
  std::string changed = *text;
  changed.replace(changed.find("\"cx\""), 4, "\"cX\"");
  EXPECT_FALSE(is_rig_intact(changed));
  solved.camera.fx = std::nan("");
  EXPECT_FALSE(solved_rig_text(nominal, solved));
}

// The rendered set of another program
// ----------------------------------------------------------------------------------

const std::string kSet = test::shared_folder() + "/data/oracle/calib-01";

class Oracle : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSet + "/target.json")) GTEST_SKIP() << kSet << " is absent";
  }
};

/// rms per axis of the dots' image places from those of the discs' true centres, px.
Eigen::Vector2d centre_error_px(const std::vector<PoseView>& poses, const TargetDesign& target, const RigState& truth) {
  const auto T_cam_model = test::true_poses(kSet + "/truth/poses.csv");
  Eigen::Vector2d squares(0, 0);
  double n = 0;
  for (const PoseView& pose : poses) {
    for (const DotView& dot : pose.dots) {
      const Vec3d p = T_cam_model.at(std::stoi(pose.name)) * target.place(dot.dot);
      const PlanePoint c = project(truth.camera, {p.x() / p.z(), p.y() / p.z()});
      squares += (dot.camera_px - Eigen::Vector2d(c.x, c.y)).cwiseAbs2();
      ++n;
    }
  }
  return (squares / n).cwiseSqrt();
}

TEST_F(Oracle, calib_01_is_solved_blind) {
  const CalibFolder folder = open_calib_folder(kSet).value();
  const MeasuredFolder measured = measure_folder(folder, {}).value();
  EXPECT_TRUE(measured.rejected.empty());
  SolveOptions options;
  options.fringe_period_px = finest_periods_px(folder);
  const Solution solution = solve(measured.views, folder.target, folder.nominal, options).value();
  const RigState truth = state_of(load_rig(kSet + "/truth/rig.json").value());
  const VolumeDifference d = compare_rigs(solution.state, truth, kRange);
  EXPECT_LT(d.p95_um, 0.35);
  EXPECT_LT(std::abs(d.scale_ppm), 12);
  for (const PlaneShape& plane : d.planes) {
    EXPECT_LT(std::abs(plane.sag_um()), 0.25);
    EXPECT_LT(std::abs(plane.twist_um), 0.25);
  }
  EXPECT_FALSE(solution.is_shape_solved);
  EXPECT_TRUE(solution.rejected.empty());
  EXPECT_FALSE(solution.state.correction) << "the set's lenses are of the model: a field could only fit noise";
  const Eigen::Vector2d centres = centre_error_px(solution.poses, folder.target, truth);
  RecordProperty("centres_px", std::to_string(centres.x()) + " " + std::to_string(centres.y()));
  EXPECT_LE(centres.maxCoeff(), 0.007) << "images of the discs' centres";
  const Eigen::Vector2d raw = centre_error_px(measured.views, folder.target, truth);
  EXPECT_GT(raw.norm(), centres.norm()) << "centres of the ellipses: what the bias costs";
}

TEST_F(Oracle, pose_without_a_fringe_image_is_named) {
  CalibFolder folder = open_calib_folder(kSet).value();
  folder.cycles_u.push_back(128);
  const auto frames = load_pose(folder, "00");
  ASSERT_FALSE(frames);
  EXPECT_THAT(frames.error().detail, testing::HasSubstr("poses/00/v_128_0.png is missing"));
}

}  // namespace
}  // namespace enamel::calib
