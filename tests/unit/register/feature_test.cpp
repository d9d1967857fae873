// Features, matching and the rigid fit: what they find, what they refuse, and that threads do not matter.
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/register/feature/features.hpp"
#include "pipeline/register/feature/rigid_ransac.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr double kPxPerMm = 1707 / 2.0 / 48;

SurfacePatch patch_at(const Pose& truth, std::uint64_t surface = 11, std::uint64_t noise = 1) {
  return ts::make_patch(ts::SyntheticSurface(surface), ts::test_rig().camera, truth, {0.01, 0.03, noise});
}

bool same(const std::vector<Feature>& a, const std::vector<Feature>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const Feature& x, const Feature& y) {
           return x.kind == y.kind && x.point == y.point && x.descriptor == y.descriptor;
         });
}

TEST(Features, do_not_depend_on_the_number_of_open_cv_threads) {
  const SurfacePatch patch = patch_at(ts::looking_down(0, 0));
  const int before = cv::getNumThreads();
  std::vector<std::vector<Feature>> runs;
  for (const int threads : {1, 2, 3, 4}) {
    cv::setNumThreads(threads);
    runs.push_back(extract_features(patch, kPxPerMm, {}));
  }
  cv::setNumThreads(before);
  ASSERT_GT(runs[0].size(), 100U);
  for (const auto& run : runs) EXPECT_TRUE(same(run, runs[0]));
}

TEST(Features, both_pictures_contribute) {
  const auto features = extract_features(patch_at(ts::looking_down(0, 0)), kPxPerMm, {});
  std::size_t relief = 0;
  for (const Feature& f : features) relief += f.kind == FeatureKind::kRelief;
  EXPECT_GT(relief, 20U);
  EXPECT_GT(features.size() - relief, 20U);
}

TEST(Features, pictures_drop_form_and_keep_detail) {
  const calib::LensValues lens = ts::test_rig().camera;
  // A tilted plane has form but no relief.
  const SurfacePatch plane =
      ts::make_patch(ts::SyntheticSurface(3, 0.0), lens, ts::looking_down(0, 0, {0.3, 0.2, 0}), {0, 0, 1});
  const FeatureImages images = make_feature_images(plane, kPxPerMm, {});
  int inner = 0;
  for (int v = 40; v < images.relief.height() - 40; ++v) {
    for (int u = 40; u < images.relief.width() - 40; ++u) {
      if (!std::isfinite(plane.depth_mm(u, v))) continue;
      ++inner;
      ASSERT_NEAR(images.relief(u, v), 128, 3) << u << ' ' << v;
    }
  }
  const int all = (images.relief.width() - 80) * (images.relief.height() - 80);
  ASSERT_GT(all, 1000);
  EXPECT_GT(inner, all * 9 / 10) << "nearly every inner pixel was looked at";
}

TEST(Features, matches_of_one_surface_agree_in_space_and_those_of_another_do_not) {
  const Pose a = ts::looking_down(0, 0);
  const Pose b = ts::looking_down(2, 1, {0.1, -0.1, 0.6});
  const auto fa = extract_features(patch_at(a, 11, 1), kPxPerMm, {});
  const auto same_surface = extract_features(patch_at(b, 11, 2), kPxPerMm, {});
  const auto pairs_of = [&](const std::vector<Feature>& fb) {
    std::vector<PointPair> pairs;
    for (const FeatureMatch& m : match_features(fb, fa, 0.8)) {
      pairs.push_back({fb[m.a].point.cast<double>(), a * fa[m.b].point.cast<double>()});
    }
    return pairs;
  };
  const auto fit = fit_rigid(pairs_of(same_surface), 5, {});
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->inliers, 30);
  EXPECT_LT(ts::point_error_mm(fit->T_to_from, b), 0.1);
  for (std::uint64_t other = 200; other < 205; ++other) {
    EXPECT_FALSE(fit_rigid(pairs_of(extract_features(patch_at(b, other, 2), kPxPerMm, {})), 5, {})) << other;
  }
}

/// n good pairs under T with noise, m wrong ones.
std::vector<PointPair> mixed_pairs(const Pose& T, int good, int wrong, std::uint64_t seed) {
  std::vector<PointPair> pairs;
  std::uint64_t key = ts::mix(seed);
  const auto point = [&](double size) {
    key += 3;
    return Vec3d(size * (2 * ts::uniform(key) - 1), size * (2 * ts::uniform(key + 1) - 1),
                 3 * (2 * ts::uniform(key + 2) - 1));
  };
  for (int i = 0; i < good; ++i) {
    const Vec3d p = point(8) + Vec3d(0, 0, 48);
    pairs.push_back({p, T * p + 0.02 * point(1)});
  }
  for (int i = 0; i < wrong; ++i) {
    const Vec3d p = point(8) + Vec3d(0, 0, 48);
    pairs.push_back({p, T * (point(8) + Vec3d(0, 0, 48))});
  }
  return pairs;
}

TEST(RigidFit, finds_a_fifth_of_good_pairs) {
  const Pose T = ts::looking_down(4, -3, {0.2, 0.1, 0.9});
  int found = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const auto fit = fit_rigid(mixed_pairs(T, 24, 96, seed), seed, {});
    found += fit && ts::point_error_mm(fit->T_to_from, T) < 0.05;
  }
  EXPECT_GE(found, 39);
}

TEST(RigidFit, finds_nothing_in_noise) {
  const Pose T = ts::looking_down(4, -3);
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    EXPECT_FALSE(fit_rigid(mixed_pairs(T, 0, 120, seed), seed, {})) << seed;
}

TEST(RigidFit, needs_twelve_whoever_they_are) {
  const Pose T = ts::looking_down(4, -3);
  EXPECT_FALSE(fit_rigid(mixed_pairs(T, 11, 0, 1), 1, {}));
  EXPECT_TRUE(fit_rigid(mixed_pairs(T, 12, 0, 1), 1, {}));
  EXPECT_FALSE(fit_rigid({}, 1, {}));
}

TEST(RigidFit, never_reflects) {
  const Pose T = ts::looking_down(0, 0);
  auto pairs = mixed_pairs(T, 40, 0, 3);
  for (PointPair& pair : pairs) pair.to.x() = -pair.to.x();
  EXPECT_FALSE(fit_rigid(pairs, 1, {}));
}

}  // namespace
}  // namespace enamel::pipeline
