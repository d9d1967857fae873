#include "calib/model/lens.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/calib/rig_text.hpp"

namespace enamel::calib {
namespace {

TEST(Lens, undistort_inverts_project_over_the_whole_image) {
  const Rig rig = parse_rig(test::kRigText).value();
  for (const LensValues& lens : {rig.camera, rig.projector}) {
    for (double v = -0.5; v <= lens.height; v += 16) {
      for (double u = -0.5; u <= lens.width; u += 16) {
        const PlanePoint back = project(lens, undistort(lens, {u, v}));
        ASSERT_NEAR(back.x, u, 1e-9);
        ASSERT_NEAR(back.y, v, 1e-9);
      }
    }
  }
}

TEST(Lens, tangential_terms_follow_opencv_order) {
  LensValues lens{100, 100, 1, 1, 0, 0, {0.1, 0.02, 0.003, 0.004, 0.005}};
  const PlanePoint d = distort(lens, {0.3, -0.2});
  // Written out by hand from the formula of OpenCV's documentation: r2 = 0.13.
  const double g = 1 + 0.1 * 0.13 + 0.02 * 0.0169 + 0.005 * 0.002197;
  EXPECT_NEAR(d.x, 0.3 * g + 2 * 0.003 * 0.3 * -0.2 + 0.004 * (0.13 + 0.18), 1e-15);
  EXPECT_NEAR(d.y, -0.2 * g + 0.003 * (0.13 + 0.08) + 2 * 0.004 * 0.3 * -0.2, 1e-15);
}

TEST(Lens, undistort_ends_with_finite_numbers_for_a_lens_that_folds) {
  const LensValues lens{640, 480, 300, 300, 320, 240, {-5, 3, 0, 0, 0}};
  const PlanePoint p = undistort(lens, {639, 479});
  EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y));
}

}  // namespace
}  // namespace enamel::calib
