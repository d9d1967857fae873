// The solver on dots of known rigs: no images, so that hundreds of rigs can be solved.
#include "calib/solve/solve.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

#include "calib/judge/volume.hpp"
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

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
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
    const double predicted = predict_difference(solved->state, solved->result.covariance, kRange).p95_um;
    ratio.push_back(test::rig_error(solved->state, scene.truth).p95_um / predicted);
  }
  EXPECT_LT(median(ratio), 1.2);
  EXPECT_GT(median(ratio), 0.7);
}

}  // namespace
}  // namespace enamel::calib
