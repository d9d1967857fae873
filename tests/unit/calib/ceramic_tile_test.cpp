// A ceramic between opaque strips: the shares of enamel's law, from points drawn with them.
#include "calib/judge/ceramic_tile.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "protocol/base/rng.hpp"

namespace enamel::calib {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 640, kHeight = 480;
constexpr double kFocal_px = 1707;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Tile {
  std::array<std::array<double, 3>, 3> shares{};
  double strip_mm = 4, noise_mm = 0.02, bow_mm = 0;  ///< bow: of the frame and all, from middle to edge
  bool all_over = true;                              ///< else the right third of the picture shows none of it
};

struct Pictures {
  Map<Vec3f> points{kWidth, kHeight, Vec3f::Constant(kNan)};
  Map<float> enamel_mm{kWidth, kHeight, kNan};
};

double share_at(const Tile& tile, double s, double t) {
  const auto parabola = [](const std::array<double, 3>& y, double x) {
    return y[1] + x * (0.5 * (y[2] - y[0]) + x * (0.5 * (y[2] + y[0]) - y[1]));
  };
  std::array<double, 3> rows{};
  for (std::size_t i = 0; i < 3; ++i) rows[i] = parabola(tile.shares[i], s);
  return parabola(rows, t);
}

/// A tilted tile, its strips shifted, of which enamel's law says 25 to 35 um.
Pictures picture_of(const Tile& tile, Rng& rng) {
  Pictures out;
  const double tilt_x = 0.1 * rng.normal(), tilt_y = 0.1 * rng.normal(), shift = tile.strip_mm * 2 * rng.uniform();
  const bool turned = rng.uniform() < 0.3;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      if (!tile.all_over && u > 2 * kWidth / 3) continue;
      const double x = (u - 319.5) / kFocal_px, y = (v - 239.5) / kFocal_px, s = (u - 319.5) / 319.5,
                   t = (v - 239.5) / 239.5;
      const double plane = 48 / (1 - tilt_x * x - tilt_y * y);
      const bool ceramic =
          std::fmod((turned ? x : y) * plane + shift + 40 * tile.strip_mm, 2 * tile.strip_mm) < tile.strip_mm;
      const double enamel = ceramic ? 0.030 + 0.004 * std::sin(0.3 * plane * x) : 0.0;
      const double z = plane + enamel * share_at(tile, s, t) + tile.noise_mm * rng.normal() + tile.bow_mm * s * s;
      out.points(u, v) = Vec3f(static_cast<float>(x * z), static_cast<float>(y * z), static_cast<float>(z));
      out.enamel_mm(u, v) = static_cast<float>(enamel);
    }
  }
  return out;
}

Result<TileFit> fit_of(const Tile& tile, int bursts, std::uint64_t seed) {
  Rng rng(seed, 0, 1);
  CeramicTile fit;
  for (int k = 0; k < bursts; ++k) {
    const Pictures p = picture_of(tile, rng);
    fit.add({p.points, p.enamel_mm, 48 / kFocal_px});
  }
  return fit.solve();
}

TEST(CeramicTile, finds_drawn_shares_over_the_picture) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Rng rng(seed, 1, 1);
    Tile tile;
    const double whole = 0.5 + 1.5 * rng.uniform();
    for (auto& row : tile.shares)
      for (double& share : row) share = whole * (1 + 0.1 * rng.normal());
    const auto fit = fit_of(tile, 12, seed);
    ASSERT_TRUE(fit) << fit.error().message();
    for (std::size_t v = 0; v < 3; ++v)
      for (std::size_t u = 0; u < 3; ++u) EXPECT_NEAR(fit->light.of_enamel[v][u], tile.shares[v][u], 0.05) << seed;
    EXPECT_EQ(fit->light.bursts, 12);
    // Noise of 20 um over squares of 256 pixels.
    EXPECT_NEAR(fit->after_um, 1.25, 0.4);
    EXPECT_LT(fit->light.sigma, 0.02);
    EXPECT_GT(fit->before_um, 10);
  }
}

TEST(CeramicTile, enamel_itself_has_shares_of_one) {
  const auto fit = fit_of({.shares = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}}, 12, 7);
  ASSERT_TRUE(fit) << fit.error().message();
  // Control: the law alone is right here, but for what noise of the frames' planes lets nine shares take up.
  EXPECT_NEAR(fit->by_enamel_um, fit->after_um, 0.4);
}

TEST(CeramicTile, what_does_not_determine_it_is_refused_with_what_to_do) {
  const Tile sound{.shares = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}};
  const auto few = fit_of(sound, 4, 1);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, ErrorCode::kCalibrationPoses);
  EXPECT_THAT(few.error().detail, HasSubstr("4 bursts"));
  Tile aside = sound;
  aside.all_over = false;
  const auto blind = fit_of(aside, 12, 1);
  ASSERT_FALSE(blind);
  EXPECT_THAT(blind.error().detail, HasSubstr("right of the picture"));
  Tile bowed = sound;
  bowed.bow_mm = 0.03;
  const auto bow = fit_of(bowed, 12, 1);
  ASSERT_FALSE(bow);
  EXPECT_EQ(bow.error().code, ErrorCode::kCalibrationRefused);
  Tile deep = sound;
  for (auto& row : deep.shares) row.fill(-1);  // the ceramic stands out of its frame
  const auto proud = fit_of(deep, 12, 1);
  ASSERT_FALSE(proud);
  EXPECT_THAT(proud.error().detail, HasSubstr("flush"));
}

TEST(CeramicTile, a_burst_without_a_frame_is_not_used) {
  Rng rng(1, 0, 1);
  Tile wide{.shares = {{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}};
  wide.strip_mm = 1e6;
  const Pictures p = picture_of(wide, rng);
  CeramicTile fit;
  EXPECT_FALSE(fit.add({p.points, p.enamel_mm, 48 / kFocal_px}));
}

}  // namespace
}  // namespace enamel::calib
