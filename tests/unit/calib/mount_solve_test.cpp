// The axes from drawn corners: planted tilt, skew, harmonics, wobble and noise; against the truth and the stated
// sigmas.
#include "calib/mount/mount_solve.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/calib/drawn_mount_set.hpp"

namespace enamel::calib {
namespace {

using testing::HasSubstr;

Drawn draw(std::uint64_t seed, const TargetDesign& target, Beyond beyond_deg) {
  return draw(seed, target, rig(), {.angles_deg = every(12, {-20, -10, 0, 10, 20}), .beyond_deg = beyond_deg});
}

TEST(MountSolve, finds_planted_axes_within_their_sigmas) {
  const TargetDesign target = points();
  int within = 0, all = 0;
  double squares = 0, places = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Drawn d = draw(seed, target, [](std::size_t) { return 0.0; });
    const auto s = solve_mount(d.stops, target, rig());
    ASSERT_TRUE(s) << s.error().message();
    EXPECT_TRUE(s->left_out.empty());
    const std::pair<LineDifference, LineSigma> lines[] = {
        {compare_lines(s->mount.rotation, d.rotation, {0, 0, 48}, 0.1), s->rotation},
        {compare_lines(s->mount.swing, d.swing, {0, 0, 48}, 0.1), s->swing}};
    for (const auto& [error, sigma] : lines) {
      EXPECT_LT(error.angle_rad, 3.5 * sigma.direction_rad);
      squares += std::pow(error.angle_rad / kDegree, 2);
      EXPECT_LT(error.distance_mm, 3.5 * sigma.place_mm);
      places += std::pow(1000 * error.distance_mm, 2);
      std::printf("seed %d: direction %.5f deg (sigma %.5f), place %.2f um (sigma %.2f)\n", static_cast<int>(seed),
                  error.angle_rad / kDegree, sigma.direction_rad / kDegree, 1000 * error.distance_mm,
                  1000 * sigma.place_mm);
      within += error.angle_rad < 2.45 * sigma.direction_rad ? 1 : 0;
      within += error.distance_mm < 2.45 * sigma.place_mm ? 1 : 0;
      all += 2;
    }
  }
  EXPECT_LT(std::sqrt(squares / (all / 2)), 0.003) << "degrees, rms over both lines of all sets";
  EXPECT_LT(std::sqrt(places / (all / 2)), 3) << "um, likewise";
  // Both are lengths in a plane: 95 % lie below 2.45 sigma. 20 draws of which 17 do and more: 98.4 % of all sets.
  EXPECT_GE(within, 17) << "of " << all;
}

TEST(MountSolve, names_a_wrong_stop_and_goes_on) {
  const TargetDesign target = points();
  const Drawn d = draw(7, target, [](std::size_t stop) { return stop == 17 ? 0.4 : 0.0; });
  const auto s = solve_mount(d.stops, target, rig());
  ASSERT_TRUE(s) << s.error().message();
  ASSERT_EQ(s->left_out.size(), 1U);
  EXPECT_EQ(s->left_out[0].pose, "17");
  EXPECT_THAT(s->left_out[0].reason, HasSubstr("table"));
  EXPECT_LT(compare_lines(s->mount.rotation, d.rotation, {0, 0, 48}, 0.1).angle_rad, 3.5 * s->rotation.direction_rad);
}

TEST(MountSolve, refuses_a_table_that_slips) {
  const TargetDesign target = points();
  const Drawn d = draw(8, target, [](std::size_t stop) { return 0.02 * static_cast<double>(stop); });
  const auto s = solve_mount(d.stops, target, rig());
  ASSERT_FALSE(s);
  EXPECT_EQ(s.error().code, ErrorCode::kCalibrationRefused);
  EXPECT_THAT(s.error().detail, HasSubstr("slips"));
}

TEST(MountSolve, refuses_too_few_stops_and_axes_that_cannot_be_told_apart) {
  const TargetDesign target = points();
  Drawn d = draw(9, target, [](std::size_t) { return 0.0; });
  const std::vector<MountStop> one_swing(d.stops.begin(), d.stops.begin() + 12);
  EXPECT_THAT(solve_mount(one_swing, target, rig()).error().detail, HasSubstr("cradle"));
  std::vector<MountStop> bound;  // every angle of the table with one swing only
  for (std::size_t k = 0; k < 12; ++k) bound.push_back(d.stops[12 * (k % 5) + k]);
  EXPECT_THAT(solve_mount(bound, target, rig()).error().detail, HasSubstr("swing alone"));
}

}  // namespace
}  // namespace enamel::calib
