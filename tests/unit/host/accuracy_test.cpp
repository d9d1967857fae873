// Trueness and precision of surfaces with drawn noise, laid anywhere: the figures are those of the noise.
#include "host/accuracy/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host/compare/compare.hpp"
#include "tests/unit/host/mesh_shapes.hpp"

namespace enamel::host {
namespace {

constexpr double kStep_mm = 0.2;

/// The relief with noise along its normals, um, laid elsewhere.
AccuracyRun scan(std::uint64_t seed, double sigma_um) {
  AccuracyRun run{"run " + std::to_string(seed), relief(kStep_mm)};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3d> out(run.file.mesh.vertices.size(), Vec3d::Zero());
  for (const auto& t : run.file.mesh.triangles) {
    const auto at = [&](int k) -> Vec3d {
      return run.file.mesh.vertices[t[static_cast<std::size_t>(k)]].cast<double>();
    };
    for (const std::uint32_t corner : t) out[corner] += (at(1) - at(0)).cross(at(2) - at(0));
  }
  const Vec3d axis = Vec3d(normal(random), normal(random), normal(random)).normalized();
  Pose T = Pose::Identity();
  T.linear() = Eigen::AngleAxisd(0.3 * normal(random), axis).toRotationMatrix();
  T.translation() = Vec3d(normal(random), normal(random), normal(random));
  for (std::size_t i = 0; i < out.size(); ++i) {
    Vec3f& v = run.file.mesh.vertices[i];
    v = (T * (v.cast<double>() + 1e-3 * sigma_um * normal(random) * out[i].normalized())).cast<float>();
  }
  return run;
}

/// What is right of x = 0 in the relief's own frame.
MeshFile right_half() {
  MeshFile out = relief(kStep_mm);
  std::erase_if(out.mesh.triangles, [&](const auto& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return out.mesh.vertices[v].x() < 0; });
  });
  return out;
}

TEST(Figures, are_those_of_known_values) {
  const DeviationFigures f = figures_of({-2, 1, 1, 4});
  EXPECT_EQ(f.count, 4U);
  EXPECT_NEAR(f.mean_abs_um, 2, 1e-12);
  EXPECT_NEAR(f.mean_um, 1, 1e-12);
  EXPECT_NEAR(f.rms_um, std::sqrt(22.0 / 4), 1e-12);
  EXPECT_NEAR(f.half_80_um, 0.5 * ((1 + 0.7 * 3) - (-2 + 0.3 * 3)), 1e-12);
  EXPECT_NEAR(f.p95_um, 2 + 0.85 * 2, 1e-12);
  EXPECT_NEAR(range_of({0, 1, 2, 3, 4}, 0.5), 2, 1e-12);
  EXPECT_EQ(figures_of({}).count, 0U);
  const std::vector<double> runs{1, 3};
  EXPECT_NEAR(spread_of(runs).sd.value_or(0), std::sqrt(2.0), 1e-12);
  EXPECT_FALSE(spread_of({runs.data(), 1}).sd.has_value());
}

TEST(Trueness, of_noise_is_the_noise) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    std::mt19937_64 random(seed);
    const double sigma = std::uniform_real_distribution<double>(3, 12)(random);
    const std::vector<AccuracyRun> runs{scan(seed, sigma), scan(seed + 100, 2 * sigma)};
    const auto result = trueness(runs, relief(kStep_mm));
    ASSERT_TRUE(result) << result.error().message();
    // rms of n normal deviates is known to 1 / sqrt(2 n), mean |d| about as well; facets beside the normal's foot are
    // nearer by less than 2 %.
    const auto n = static_cast<double>(runs[0].file.mesh.vertices.size());
    const double limit = 4 / std::sqrt(2 * n) + 0.02;
    for (const std::size_t k : {0U, 1U}) {
      const DeviationFigures& f = (*result)[k].figures;
      const double s = sigma * (k == 0 ? 1 : 2);  // the second run is the control: twice the noise is seen as twice
      EXPECT_NEAR(f.rms_um, s, limit * s) << seed;
      EXPECT_NEAR(f.mean_abs_um, s * std::sqrt(2 / std::numbers::pi), limit * s) << seed;
      EXPECT_NEAR(f.p95_um, 1.96 * s, 3 * limit * s) << seed;
      EXPECT_NEAR(f.half_80_um, 1.2816 * s, 3 * limit * s) << seed;
      EXPECT_NEAR(f.mean_um, 0, 4 * s / std::sqrt(n) + 0.02 * s) << seed;
    }
  }
}

TEST(Trueness, a_comparison_lies_where_the_run_was_laid_and_fits_nothing_anew) {
  const std::vector<AccuracyRun> runs{scan(21, 8)};
  const std::vector<MeshFile> reference{relief(kStep_mm)};
  const auto laid = trueness(runs, reference[0]);
  ASSERT_TRUE(laid) << laid.error().message();
  const auto rms_at = [&](const Pose& T) {
    const CompareInput input{
        .alignment = Alignment::kBest, .mesh_origin_mm = runs[0].file.origin_mm, .best_T_reference_mesh = &T};
    const auto result = compare(runs[0].file.mesh, reference, input);
    EXPECT_TRUE(result) << result.error().message();
    return result->rms_um;
  };
  const DeviationFigures& f = (*laid)[0].figures;
  EXPECT_NEAR(rms_at((*laid)[0].T_reference_run), f.rms_um, 0.01);
  // A fit of its own would undo this.
  const Pose off = Pose(Eigen::Translation3d(0, 0, 0.05)) * (*laid)[0].T_reference_run;
  EXPECT_GT(rms_at(off), 3 * f.rms_um);
}

TEST(Trueness, a_dent_shows) {
  const auto dent = [](double x, double) { return x > 5 ? -0.06 : 0.0; };
  AccuracyRun run{"dented", relief(kStep_mm, dent)};
  const auto result = trueness({&run, 1}, relief(kStep_mm));
  ASSERT_TRUE(result);
  EXPECT_GT((*result)[0].figures.p95_um, 30);
  EXPECT_LT((*result)[0].figures.mean_um, -5);
}

TEST(Precision, of_independent_noise_is_root_two_of_it) {
  const double sigma = 6;
  const std::vector<AccuracyRun> runs{scan(21, sigma), scan(22, sigma), scan(23, sigma)};
  const auto pairs = precision(runs);
  ASSERT_TRUE(pairs) << pairs.error().message();
  ASSERT_EQ(pairs->size(), 3U);
  for (const PairDeviation& p : *pairs) {
    EXPECT_LT(p.first, p.second);
    EXPECT_NEAR(p.figures.rms_um, std::numbers::sqrt2 * sigma, 0.06 * sigma);
  }
  // Control: a run beside itself without noise of its own.
  const std::vector<AccuracyRun> same{runs[0], runs[0]};
  const auto none = precision(same);
  ASSERT_TRUE(none);
  EXPECT_LT(none->front().figures.p95_um, 0.05);
  EXPECT_TRUE(precision({runs.data(), 1})->empty());
}

TEST(Precision, what_the_other_run_did_not_see_is_no_deviation) {
  const std::vector<AccuracyRun> runs{{"whole", relief(kStep_mm)}, {"half", right_half()}};
  const auto pairs = precision(runs);
  ASSERT_TRUE(pairs) << pairs.error().message();
  // Of 101 x 61 vertices 50 columns are beyond, and 61 + 61 + 2 x 49 lie on the half's border.
  EXPECT_NEAR(pairs->front().beyond_border_pct, 100.0 * (50 * 61 + 220) / (101 * 61), 0.5);
  EXPECT_LT(pairs->front().figures.p95_um, 1);
  // Control: against a reference all of it counts.
  const auto all = trueness({runs.data(), 1}, right_half());
  EXPECT_TRUE(!all || all->front().figures.p95_um > 1000);
}

TEST(Accuracy, what_does_not_lie_on_each_other_is_refused) {
  const std::vector<AccuracyRun> runs{{"relief", relief(kStep_mm)}, {"ball", ball(9, 60)}};
  const auto pairs = precision(runs);
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().code, ErrorCode::kMeshInvalid);
  EXPECT_NE(pairs.error().detail.find("relief on ball"), std::string::npos) << pairs.error().detail;
  const AccuracyRun empty{"empty", {}};
  EXPECT_FALSE(trueness({&empty, 1}, relief(kStep_mm)));
  EXPECT_FALSE(trueness(runs, {}));
}

}  // namespace
}  // namespace enamel::host
