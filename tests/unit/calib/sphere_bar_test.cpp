// Two spheres as a length standard: sizes, form and distance from points of known spheres.
#include "calib/judge/sphere_bar.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

constexpr double kFocal_px = 850;  // every second pixel of the reference design

struct Ball {
  Vec3d centre;
  double radius_mm;
};

/// Points of balls as a camera of 320 x 240 px sees them, with noise along the ray, times `scale`.
std::vector<BarPoint> view_of(const std::vector<Ball>& balls, double sigma_mm, double scale, Rng& rng) {
  std::vector<BarPoint> points;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const Vec3d ray = Vec3d((u - 160) / kFocal_px, (v - 120) / kFocal_px, 1);
      double nearest = std::numeric_limits<double>::max();
      for (const Ball& b : balls) {
        const double along = ray.dot(b.centre) / ray.squaredNorm();
        const double rest = along * along - (b.centre.squaredNorm() - b.radius_mm * b.radius_mm) / ray.squaredNorm();
        if (rest > 0) nearest = std::min(nearest, along - std::sqrt(rest));
      }
      if (nearest > 1e3) continue;
      points.push_back({u, v, scale * ray * (nearest + sigma_mm * rng.normal()), sigma_mm});
    }
  }
  return points;
}

const std::vector<Ball> kBar{{{-4.25, 0.3, 48.6}, 2.5}, {{3.74, -0.2, 48.2}, 3.0}};
const BarDesign kDesign{{5, 6}, (kBar[1].centre - kBar[0].centre).norm()};

TEST(SphereBar, sizes_and_distance_lie_within_their_own_errors) {
  Rng rng(1, 0, 1);
  const auto bar = check_bar(view_of(kBar, 0.02, 1, rng));
  ASSERT_TRUE(bar) << bar.error().message();
  for (std::size_t i = 0; i < 2; ++i) {
    const SphereFit& s = bar->spheres[i];
    EXPECT_NEAR(s.diameter_mm(), kDesign.diameter_mm[i], 4 * s.diameter_sigma_mm());
    EXPECT_LT(s.diameter_sigma_mm(), 0.004);
    EXPECT_LT(s.form_p95_um, 15);
  }
  EXPECT_NEAR(bar->distance_mm, kDesign.distance_mm, 4 * bar->distance_sigma_mm);
  EXPECT_THAT(judge_bar(*bar, kDesign), testing::IsEmpty());
}

TEST(SphereBar, stated_errors_are_those_of_repetition) {
  double squares = 0, stated = 0;
  constexpr int kRuns = 20;
  for (int run = 0; run < kRuns; ++run) {
    Rng rng(static_cast<std::uint64_t>(run), 1, 1);
    const auto bar = check_bar(view_of(kBar, 0.02, 1, rng)).value();
    squares += std::pow(bar.distance_mm - kDesign.distance_mm, 2) / kRuns;
    stated += std::pow(bar.distance_sigma_mm, 2) / kRuns;
  }
  EXPECT_NEAR(std::sqrt(squares / stated), 1, 0.4);
}

TEST(SphereBar, wrong_scale_is_refused_with_the_length_named) {
  Rng rng(2, 0, 1);
  const auto bar = check_bar(view_of(kBar, 0.02, 1.002, rng));
  ASSERT_TRUE(bar);
  EXPECT_THAT(judge_bar(*bar, kDesign),
              testing::Contains(testing::HasSubstr("the distance of the spheres is off by +")));
}

TEST(SphereBar, one_sphere_is_no_bar) {
  Rng rng(3, 0, 1);
  EXPECT_FALSE(check_bar(view_of({kBar[0]}, 0.02, 1, rng)));
  EXPECT_FALSE(check_bar({}));
}

}  // namespace
}  // namespace enamel::calib
