// The edentulous ridge: its stated dimensions, its relief and vessels, and that both can be left out.
#include <algorithm>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/optics/random.hpp"
#include "tools/twin/surface/texture.hpp"

namespace enamel::twin {
namespace {

RidgeConfig coarse_ridge(double relief_um) {
  RidgeConfig c;
  c.relief_um = relief_um;
  c.max_edge_mm = 0.4;
  c.from_mm = -30;
  c.to_mm = 30;
  return c;
}

/// Largest deviation of the mesh from the smooth profile, along z, on and about the crest.
double roughness(const Ridge& ridge) {
  const ArchCoordinates where{Arch(ridge.shape)};
  double largest = 0;
  for (const auto& v : ridge.mesh.vertices) {
    const auto a = where.at(static_cast<double>(v.x()), static_cast<double>(v.y()));
    if (std::abs(a.n) < 3) largest = std::max(largest, std::abs(static_cast<double>(v.z()) - RidgeField::profile(a)));
  }
  return largest;
}

TEST(TwinRidge, has_the_stated_dimensions) {
  EXPECT_EQ(RidgeField::profile({0, 0}), 0);
  EXPECT_NEAR(RidgeField::profile({40, 0}), 0.5, 1e-9);
  EXPECT_NEAR(RidgeField::profile({0, 12}), -18.8, 1e-9);
  EXPECT_NEAR(RidgeField::profile({0, -15}), -13.7, 1e-9);
  EXPECT_GT(RidgeField::profile({0, 4.2}), -4.0);  // the shoulder in front, and behind
  EXPECT_GT(RidgeField::profile({40, 6.4}), -3.5);
}

TEST(TwinRidge, is_smooth_without_relief_and_as_rough_as_stated_with_it) {
  const double smooth = roughness(make_ridge(coarse_ridge(0), 3)), rough = roughness(make_ridge(coarse_ridge(30), 3));
  EXPECT_LT(smooth, 0.01);
  EXPECT_GT(rough, 0.05);
  EXPECT_LT(rough, 0.5);
}

TEST(TwinRidge, folds_lie_behind_the_front_and_not_at_the_back) {
  const RidgeField field(30, 3), even(0, 3);
  const auto relief_at = [&](double s) {
    double largest = 0;
    for (double n = -9; n < -5; n += 0.1) {
      const Eigen::Vector2d p = field.arch().point(s) + n * field.arch().buccal(s);
      const Eigen::Vector3d q(p.x(), p.y(), RidgeField::profile({s, n}));
      largest = std::max(largest, std::abs(field.value(q) - even.value(q)));
    }
    return largest;
  };
  EXPECT_GT(relief_at(6), 0.15);
  EXPECT_LT(relief_at(30), 0.13);
}

TEST(TwinRidge, field_rises_no_faster_than_its_bound) {
  const RidgeField field(30, 3);
  const CounterRandom random(1, 1);
  int tried = 0;
  double steepest = 0;
  for (std::uint64_t i = 0; i < 300000; ++i) {
    const Eigen::Vector3d p(random.uniform(8 * i, -35, 35), random.uniform(8 * i + 1, -48, 11),
                            random.uniform(8 * i + 2, -18, 1));
    if (const double v = field.value(p); std::abs(v) < 0.02) {
      const NormalPair a = random.normals(4 * i + 1), b = random.normals(4 * i + 2);
      const Eigen::Vector3d way = 0.12 * Eigen::Vector3d(a.a, a.b, b.a).normalized();
      steepest = std::max(steepest, std::abs(field.value(p + way) - v) / way.norm());
      ++tried;
    }
  }
  EXPECT_GT(tried, 200);
  EXPECT_LE(steepest, RidgeField::kLipschitz);
  EXPECT_GT(steepest, 0.5 * RidgeField::kLipschitz);
}

TEST(TwinTexture, vessels_darken_a_small_part_by_the_amplitude) {
  TriSurface plane = make_plane({.half_mm = 15, .grid_mm = 0.1}).mesh;
  std::fill(plane.albedo.begin(), plane.albedo.end(), 0.6F);
  TriSurface plain = plane;
  apply_texture(plain, {TexturePattern::kVessels, 0.0, 1.6}, 5);
  EXPECT_EQ(plain.albedo, plane.albedo);
  apply_texture(plane, {TexturePattern::kVessels, 0.15, 1.6}, 5);
  const auto [darkest, brightest] = std::minmax_element(plane.albedo.begin(), plane.albedo.end());
  EXPECT_NEAR(*darkest, 0.85F * 0.6F, 0.001F);
  EXPECT_LE(*brightest, 0.6F);
  const auto dark = std::count_if(plane.albedo.begin(), plane.albedo.end(), [](float a) { return a < 0.96F * 0.6F; });
  const double share = static_cast<double>(dark) / static_cast<double>(plane.albedo.size());
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.35);
}

TEST(TwinRidge, a_hand_goes_along_it_and_its_keys_are_checked) {
  const auto error_of = [](const std::string& object) {
    auto reader = ConfigReader::from_text(
        "[object]\ntype='ridge'\n" + object + "[path]\ntype='arch'\n[[path.pass]]\nfrom_mm=1.0\n", "test.toml");
    if (!reader) return reader.error().message();
    SceneConfig c;
    bind_scene(*reader, c);
    const auto done = reader->finish();
    return done ? std::string() : done.error().message();
  };
  EXPECT_EQ(error_of("ridge.relief_um=0.0\n"), "");
  EXPECT_NE(error_of("ridge.relief_um=-1.0\n").find("ridge.relief_um"), std::string::npos);
  EXPECT_NE(error_of("ridge.to_mm=57.0\n").find("ridge.to_mm"), std::string::npos);
  EXPECT_NE(error_of("ridge.rugae=1.0\n").find("rugae"), std::string::npos);
  EXPECT_NE(error_of("[texture]\npattern='veins'\n").find("texture.pattern"), std::string::npos);
}

}  // namespace
}  // namespace enamel::twin
