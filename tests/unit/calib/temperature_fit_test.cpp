// Temperature terms from sets taken cold and warm: a probe of the tests' own making drifts, dots are seen at either
// end.
#include "calib/solve/temperature_fit.hpp"

#include <gmock/gmock.h>

#include "calib/solve/solve.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::calib {
namespace {

constexpr double kReference_c = 32;
constexpr double kFocal_px_k = 0.03, kCentre_px_k = -0.02, kTurn_rad_k = 8e-6, kShift_mm_k = 2e-4;

/// The probe of `base` at a temperature: the drift written out again, a turn about the projector's y axis.
RigState at_temperature(const RigState& base, double temp_c) {
  RigState s = base;
  const double k = temp_c - kReference_c;
  s.camera.fx += kFocal_px_k * k;
  s.projector.cx += kCentre_px_k * k;
  s.T_proj_cam.linear() =
      Eigen::AngleAxisd(kTurn_rad_k * k, Vec3d::UnitY()).toRotationMatrix() * base.T_proj_cam.linear();
  s.T_proj_cam.translation().x() += kShift_mm_k * k;
  return s;
}

struct Taken {
  test::CalibScene scene;
  RigAtTemperature solved;
};

Taken taken(const RigState& probe, std::uint64_t seed, double temp_c, double drawn_at_c) {
  Taken t{test::make_calib_scene(seed, 12), {}};
  const auto poses = t.scene.truth.T_cam_target;
  const auto offsets = t.scene.truth.dot_offsets_mm;
  t.scene.truth = at_temperature(probe, drawn_at_c);
  t.scene.truth.T_cam_target = poses;
  t.scene.truth.dot_offsets_mm = offsets;
  Rng rng(seed, 7, 1);
  SolveOptions options;
  options.shape = ShapeChoice::kPerfect;
  auto solved = solve(test::make_views(t.scene, {.centre_px = 0.003}, rng), t.scene.target, t.scene.nominal, options);
  EXPECT_TRUE(solved) << solved.error().message();
  if (solved) t.solved = {solved->state, solved->result.covariance, temp_c};
  return t;
}

class TemperatureFitTest : public testing::Test {
 protected:
  const RigState probe_ = test::make_calib_scene(700, 3).truth;
  const Taken cold_ = taken(probe_, 701, 22, 22), warm_ = taken(probe_, 702, 42, 42);
};

/// What a rig.json with the fit's terms becomes at a temperature.
RigState fitted_at(const TemperatureFit& fit, double temp_c) {
  Rig rig;
  rig.camera = fit.state.camera;
  rig.projector = fit.state.projector;
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c)
      rig.T_proj_cam[r][c] = fit.state.T_proj_cam.matrix()(static_cast<int>(r), static_cast<int>(c));
  rig.temperature = fit.terms;
  rig = rig_at(rig, temp_c);
  RigState s = fit.state;
  s.camera = rig.camera;
  s.projector = rig.projector;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c)
      s.T_proj_cam.matrix()(r, c) = rig.T_proj_cam[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return s;
}

TEST_F(TemperatureFitTest, two_sets_give_the_rates_and_the_rig_in_between) {
  const auto fit = fit_temperature({cold_.solved, warm_.solved});
  ASSERT_TRUE(fit) << fit.error().message();
  EXPECT_DOUBLE_EQ(fit->terms.reference_c, 32);
  EXPECT_NEAR(fit->terms.camera.fx, kFocal_px_k, 4 * fit->sigma[0]);
  EXPECT_NEAR(fit->terms.projector.cx, kCentre_px_k, 4 * fit->sigma[6]);
  EXPECT_NEAR(fit->terms.rotation_rad[1], kTurn_rad_k, 4 * fit->sigma[9]);
  EXPECT_NEAR(fit->terms.translation_mm[0], kShift_mm_k, 4 * fit->sigma[11]);
  EXPECT_LT(fit->sigma[9], kTurn_rad_k / 2) << "or the rates above say nothing";

  const double ends = std::max(test::rig_error(cold_.solved.state, cold_.scene.truth).p95_um,
                               test::rig_error(warm_.solved.state, warm_.scene.truth).p95_um);
  for (const double temp_c : {22., 37., 42.}) {
    const RigState truth = at_temperature(probe_, temp_c);
    EXPECT_LT(test::rig_error(fitted_at(*fit, temp_c), truth).p95_um, 1.5 * ends) << temp_c;
  }
  // Without the terms ten kelvins are many times that.
  EXPECT_GT(test::rig_error(fit->state, at_temperature(probe_, 42)).p95_um, 5 * ends);
}

TEST_F(TemperatureFitTest, three_sets_that_lie_on_no_line_are_refused) {
  const Taken between = taken(probe_, 703, 32, 32), odd = taken(probe_, 704, 32, 52);
  EXPECT_TRUE(fit_temperature({cold_.solved, between.solved, warm_.solved}));
  const auto refused = fit_temperature({cold_.solved, odd.solved, warm_.solved});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kCalibrationRefused);
}

TEST_F(TemperatureFitTest, what_cannot_be_joined_is_refused_with_the_reason) {
  const auto says = [](std::vector<RigAtTemperature> sets, ErrorCode code, const char* words) {
    const auto fit = fit_temperature(sets);
    ASSERT_FALSE(fit) << words;
    EXPECT_EQ(fit.error().code, code);
    EXPECT_THAT(fit.error().detail, testing::HasSubstr(words));
  };
  says({cold_.solved}, ErrorCode::kCalibrationPoses, "two calibrations");
  RigAtTemperature near = warm_.solved;
  near.temp_c = 24;
  says({cold_.solved, near}, ErrorCode::kCalibrationPoses, "2.0 K apart");
  RigAtTemperature bare = warm_.solved;
  bare.covariance.resize(0, 0);
  says({cold_.solved, bare}, ErrorCode::kRigInvalid, "no covariance");
  RigAtTemperature bent = warm_.solved;
  bent.state.correction.emplace();
  says({cold_.solved, bent}, ErrorCode::kRigInvalid, "correction field");
  RigAtTemperature small = warm_.solved;
  small.state.camera.width /= 2;
  says({cold_.solved, small}, ErrorCode::kRigInvalid, "sizes");
}

}  // namespace
}  // namespace enamel::calib
