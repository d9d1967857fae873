// The bar with balls beside an arch, and its certificate.
#include "tools/twin/jaw/sphere_bar.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace enamel::twin {
namespace {

SphereBarConfig four_balls() {
  SphereBarConfig config;
  config.arc_mm = {43, 13, -16, -41};
  config.diameters_mm = {3.0, 3.5, 3.0, 3.5};
  return config;
}

TEST(SphereBar, balls_lie_beside_the_arch_and_rods_join_them) {
  const SphereBar bar = make_sphere_bar(four_balls(), ArchShape{}, 1);
  ASSERT_EQ(bar.balls.size(), 4U);
  EXPECT_EQ(bar.balls[1].radius, 1.75);
  for (const Ball& ball : bar.balls) EXPECT_EQ(ball.centre.z(), 5.5);
  EXPECT_LT(bar.balls[0].centre.x(), 26 - 5) << "inside the arch";
  EXPECT_FALSE(bar.rods.triangles.empty());
  SphereBarConfig bare = four_balls();
  bare.rod_diameter_mm = 0;
  EXPECT_TRUE(make_sphere_bar(bare, ArchShape{}, 1).rods.triangles.empty());
  EXPECT_TRUE(make_sphere_bar({}, ArchShape{}, 1).balls.empty());
}

TEST(SphereBar, certified_distances_are_off_by_draws_of_their_sigma) {
  double chi2 = 0;
  constexpr std::uint64_t kSeeds = 20;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SphereBar bar = make_sphere_bar(four_balls(), ArchShape{}, seed);
    const auto json = nlohmann::json::parse(bar.certificate_json);
    ASSERT_EQ(json["spheres"].size(), 4U);
    ASSERT_EQ(json["distances_mm"].size(), 6U);
    for (const auto& d : json["distances_mm"]) {
      const auto& a = bar.balls[d[0].get<std::size_t>()];
      const auto& b = bar.balls[d[1].get<std::size_t>()];
      EXPECT_EQ(d[3].get<double>(), 0.0025);
      const double off = (d[2].get<double>() - (a.centre - b.centre).norm()) / 0.0025;
      chi2 += off * off / (6.0 * kSeeds);
    }
  }
  EXPECT_GT(chi2, 0.6);
  EXPECT_LT(chi2, 1.5);
  EXPECT_EQ(make_sphere_bar(four_balls(), ArchShape{}, 7).certificate_json,
            make_sphere_bar(four_balls(), ArchShape{}, 7).certificate_json);
}

}  // namespace
}  // namespace enamel::twin
