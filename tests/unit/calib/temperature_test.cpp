// Drift with temperature: what rig.json says, what the rig becomes, and which burst it does not cover.
#include "calib/model/temperature.hpp"

#include <gmock/gmock.h>

#include "calib/model/lens.hpp"
#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

const std::string kTerms = R"("units": "mm", "temp_c": 32.0, "temperature": {"reference_c": 32.0, "range_c": [22, 42],
  "per_kelvin": {"camera": {"fx": 0.02, "cx": -0.01}, "projector": {"fy": 0.03},
                 "rotation_rad": [0, 2e-5, 0], "translation_mm": [1e-4, 0, 0]}})";

Rig drifting_rig() { return parse_rig(test::rig_text_with(R"("units": "mm")", kTerms)).value(); }

TEST(Temperature, rig_without_terms_stays_as_it_is) {
  const Rig rig = parse_rig(test::kRigText).value();
  const Rig warm = rig_at(rig, 50);
  EXPECT_EQ(warm.camera.fx, rig.camera.fx);
  EXPECT_EQ(warm.T_proj_cam, rig.T_proj_cam);
}

TEST(Temperature, terms_move_the_optics_in_proportion) {
  const Rig rig = drifting_rig();
  EXPECT_TRUE(rig.unknown_keys.empty());
  const Rig same = rig_at(rig, 32), warm = rig_at(rig, 37);
  EXPECT_EQ(same.camera.fx, rig.camera.fx);
  EXPECT_NEAR(warm.camera.fx, rig.camera.fx + 0.1, 1e-12);
  EXPECT_NEAR(warm.camera.cx, rig.camera.cx - 0.05, 1e-12);
  EXPECT_NEAR(warm.projector.fy, rig.projector.fy + 0.15, 1e-12);
  EXPECT_NEAR(warm.T_proj_cam[0][3], rig.T_proj_cam[0][3] + 5e-4, 1e-12);
  // A turn about y by 1e-4 rad brings the z row's share into the x row.
  EXPECT_NEAR(warm.T_proj_cam[0][2], rig.T_proj_cam[0][2] + 1e-4 * rig.T_proj_cam[2][2], 1e-8);
  for (std::size_t a = 0; a < 3; ++a) {
    double length = 0;
    for (std::size_t r = 0; r < 3; ++r) length += warm.T_proj_cam[r][a] * warm.T_proj_cam[r][a];
    EXPECT_NEAR(length, 1, 1e-9) << "still a rotation";
  }
}

TEST(Temperature, terms_are_not_extrapolated) {
  const Rig rig = drifting_rig();
  EXPECT_EQ(rig_at(rig, 60).camera.fx, rig_at(rig, 42).camera.fx);
  EXPECT_DOUBLE_EQ(kelvins_beyond(rig, 45).value(), 3);
  EXPECT_DOUBLE_EQ(kelvins_beyond(rig, 20).value(), 2);
  EXPECT_DOUBLE_EQ(kelvins_beyond(rig, 30).value(), 0);
}

TEST(Temperature, without_terms_the_calibrations_own_temperature_counts) {
  const Rig plain = parse_rig(test::kRigText).value();
  EXPECT_FALSE(kelvins_beyond(plain, 30));
  const Rig taken = parse_rig(test::rig_text_with(R"("units": "mm")", R"("units": "mm", "temp_c": 25)")).value();
  EXPECT_DOUBLE_EQ(kelvins_beyond(taken, 30).value(), 5);
}

TEST(Temperature, bad_terms_are_refused_with_the_key) {
  const auto says = [](const std::string& terms, const char* key) {
    const auto rig = parse_rig(test::rig_text_with(R"("units": "mm")", R"("units": "mm", )" + terms));
    ASSERT_FALSE(rig) << terms;
    EXPECT_THAT(rig.error().detail, testing::HasSubstr(key));
  };
  says(R"("temperature": {"range_c": [20, 40], "per_kelvin": {}})", "temperature.reference_c");
  says(R"("temperature": {"reference_c": 30, "range_c": [40, 20], "per_kelvin": {}})", "temperature.range_c");
  says(R"("temperature": {"reference_c": 30, "range_c": [20, 40]})", "temperature.per_kelvin");
  says(R"("temperature": {"reference_c": 30, "range_c": [20, 40], "per_kelvin": {"rotation_rad": [1]}})",
       "rotation_rad");
  says(
      R"("correction": {"u_px": [0, 639], "v_px": [0, 479], "inverse_mm": [0.01, 0.02], "terms": [9, 1, 1], "coefficients": []})",
      "correction.terms");
  says(
      R"("correction": {"u_px": [0, 639], "v_px": [0, 479], "inverse_mm": [0.01, 0.02], "terms": [2, 1, 1], "coefficients": [0]})",
      "correction.coefficients");
}

}  // namespace
}  // namespace enamel::calib
