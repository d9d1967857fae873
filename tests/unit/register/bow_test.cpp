// A bow of the rig itself: found where a part of the scan is rolled, left alone where nothing tells it.
#include "pipeline/register/map/bow.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/flow/parallel.hpp"
#include "pipeline/register/map/refine_map.hpp"
#include "tests/unit/register/burst_times.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr int kSweep = 6, kRolled = 5;
constexpr double kNoise_mm = 0.01;

/// What a rig with this bow measures of what `exact` shows: deeper by (z / 48)^2 (a x^2 + b x y + c y^2), x and y 1 at
/// the field's edges.
SurfacePatch bent(const SurfacePatch& exact, const calib::LensValues& camera, const BowVector& bow,
                  std::uint64_t seed) {
  SurfacePatch out = exact;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const std::size_t i = out.depth_mm.index(u, v);
      if (!std::isfinite(out.depth_mm[i])) continue;
      const Vec3d ray = ts::pixel_ray(camera, u, v);
      const double x = ray.x() * camera.fx / (0.5 * camera.width), y = ray.y() * camera.fy / (0.5 * camera.height);
      double z = out.depth_mm[i];
      z += z * z / (48 * 48) * (bow[0] * x * x + bow[1] * x * y + bow[2] * y * y);
      z += kNoise_mm * ts::normal(ts::mix(seed) + i);
      out.depth_mm[i] = static_cast<float>(z);
      out.sigma_mm[i] = static_cast<float>(kNoise_mm);
      out.points[i] = (z * ray).cast<float>();
    }
  }
  return out;
}

/// A straight sweep from above; views of the same place, rolled by drawn angles; all as a sound rig would show them.
class Bow : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    rig_ = ts::test_rig(4);
    const ts::SyntheticSurface surface(61);
    for (int n = 0; n < kSweep + kRolled; ++n) {
      const double turn = ts::uniform(static_cast<std::uint64_t>(n));
      const Pose straight = ts::looking_down(2.0 * (n < kSweep ? n : n - kSweep), 0.3 * turn);
      const double roll = n < kSweep ? 0.0 : (60 + 60 * turn) * std::numbers::pi / 180;
      truth_.push_back(straight * Eigen::AngleAxisd(roll, Vec3d::UnitZ()));
      exact_.push_back(ts::make_patch(surface, rig_.camera, truth_.back(), {0, 0.0, 1}));
    }
  }
  /// Of the first `bursts` of them, measured with this bow.
  static RefinedMap refine(const BowVector& bow, std::uint64_t seed, int bursts) {
    MapInput input;
    std::vector<SurfacePatch> patches;
    for (int n = 0; n < bursts; ++n) {
      const auto at = static_cast<std::size_t>(n);
      patches.push_back(bent(exact_[at], rig_.camera, bow, 100 * seed + at));
      input.bursts.push_back({time_of(n), truth_[0].inverse() * truth_[at]});
    }
    input.load = [&](std::size_t n) { return patches[n]; };
    input.for_each = [](std::size_t count, const std::function<void(std::size_t)>& work) {
      flow::for_each_index(count, 2, work);
    };
    MapConfig config;
    config.view_stride_px = 1;  // pixels are four times as large as a probe's
    config.sample_stride_px = 2;
    config.bow.edge.every = 2;
    return refine_map(input, rig_, {}, config);
  }
  static BowVector drawn(std::uint64_t seed, double sigma_mm) {
    return sigma_mm * BowVector(ts::normal(7 * seed), ts::normal(7 * seed + 1), ts::normal(7 * seed + 2));
  }
  inline static calib::Rig rig_;
  inline static std::vector<Pose> truth_;
  inline static std::vector<SurfacePatch> exact_;
};

TEST_F(Bow, is_taken_out_of_a_patch_to_what_a_sound_rig_would_measure) {
  for (const SurfacePatch& exact : {exact_[0], exact_[kSweep]}) {
    const BowVector bow(0.02, -0.015, 0.01);
    SurfacePatch patch = bent(exact, rig_.camera, bow, 5);
    const SurfacePatch sound = bent(exact, rig_.camera, BowVector::Zero(), 5);
    BowField(rig_).take_out(bow, patch);
    double worst = 0;
    for (std::size_t i = 0; i < patch.points.size(); ++i) {
      if (std::isfinite(patch.depth_mm[i]))
        worst = std::max(worst, (patch.points[i] - sound.points[i]).cast<double>().norm());
    }
    // derived: noise of 6 sigma shifts a bow of 45 um by 2 * 45 / 48 000 of it, 0.11 um; along the ray a little more
    EXPECT_LT(worst, 2e-4);
  }
}

TEST_F(Bow, turns_normals_with_the_surface) {
  SurfacePatch patch = ts::make_patch(ts::SyntheticSurface(61, 0), rig_.camera, ts::looking_down(0, 0), {0, 0.0, 1});
  BowField(rig_).take_out({0.05, 0.035, -0.025}, patch);  // turns normals by 0.01 rad, 1e-4 of second order
  for (int v = 10; v + 10 < rig_.camera.height; v += 10) {
    for (int u = 10; u + 10 < rig_.camera.width; u += 10) {
      const Vec3d along = (patch.points(u + 2, v) - patch.points(u - 2, v)).cast<double>().normalized();
      const Vec3d down = (patch.points(u, v + 2) - patch.points(u, v - 2)).cast<double>().normalized();
      EXPECT_NEAR(patch.normals(u, v).cast<double>().dot(along), 0, 1e-4) << u << ", " << v;
      EXPECT_NEAR(patch.normals(u, v).cast<double>().dot(down), 0, 1e-4) << u << ", " << v;
    }
  }
}

TEST_F(Bow, is_judged_by_what_the_scan_adds_to_the_prior) {
  const BowConfig config;
  const auto judged = [&](double found_mm, double share) {
    BowEstimate estimate;
    estimate.prior = BowMatrix::Identity() * config.prior_mm * config.prior_mm;
    estimate.covariance = estimate.prior;
    estimate.covariance(1, 1) *= share * share;
    estimate.bow[1] = found_mm;
    return judge_bow(estimate, config);
  };
  const BowFacts told = judged(0.016, 0.2);
  EXPECT_TRUE(told.applied);
  EXPECT_EQ(told.determined, 1);
  EXPECT_NEAR(told.taken_out[1], 0.016, 1e-12);
  EXPECT_FALSE(judged(0.01, 0.2).applied) << "2.5 sigma";
  const BowFacts unknown = judged(0.04, 0.9);
  EXPECT_FALSE(unknown.applied) << "hardly more than the prior";
  EXPECT_TRUE(unknown.taken_out.isZero(0));
}

TEST_F(Bow, of_a_chain_is_as_known_as_before_and_bends_it_as_much) {
  constexpr std::size_t kChain = 6;
  constexpr double kTurn = 0.2, kSigma_mm = 0.02, kUp_mm = 10;  // each mm of x^2 turns an edge by 0.2 rad about y
  std::vector<Pose> poses;
  std::vector<MapEdge> edges;
  std::vector<EdgeBow> bows;
  const GraphConfig graph;
  for (std::size_t n = 0; n < kChain; ++n) {
    poses.push_back(Pose(Eigen::Translation3d(2.0 * static_cast<double>(n), 0, 0)));
    if (n == 0) continue;
    MapEdge edge;
    edge.i = n;
    edge.j = n - 1;
    edge.T_j_i = poses[n - 1].inverse() * poses[n];
    edge.H = 1e12 * Matrix6::Identity();
    edges.push_back(edge);
    bows.push_back({});
    bows.back().motion(1, 0) = kTurn * graph.rho_mm;
  }
  const SolvedGraph straight = solve_graph(poses, edges, graph);
  const BowMatrix prior = BowMatrix::Identity() * kSigma_mm * kSigma_mm;
  const SolvedGraph bent = solve_graph(poses, edges, graph, {}, {}, {bows, prior});
  ASSERT_TRUE(bent.bow);
  EXPECT_NEAR(std::sqrt(bent.bow->covariance(0, 0)), kSigma_mm, 0.01 * kSigma_mm);
  const NodePoint first{0, Vec3d::Zero()}, last{kChain - 1, Vec3d(10, 0, kUp_mm)};
  const double far = last.p_model.norm();
  // each edge turns all that follows: 5 turns take the point along by its height, and lower it by 1 + … + 5 times 2 mm
  const double along = (5 * kUp_mm * 10 - (1 + 2 + 3 + 4 + 5) * 2 * kUp_mm) * kTurn / far * kSigma_mm;
  const double without = straight.covariance->sigma_of_distance_mm(first, last);
  const auto with = covariance_with_bow(straight, edges, bows, graph, kSigma_mm);
  EXPECT_LT(without, 0.1 * std::abs(along));
  EXPECT_NEAR(with->sigma_of_distance_mm(first, last), std::abs(along), 0.1 * std::abs(along) + without);
}

TEST_F(Bow, of_a_rolled_scan_is_found_within_its_own_sigma) {
  constexpr int kDraws = 20;
  int within = 0, applied = 0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const BowVector bow = drawn(seed, BowConfig{}.prior_mm);
    const RefinedMap map = refine(bow, seed, kSweep + kRolled);
    ASSERT_TRUE(map.bow);
    const BowVector off = (map.bow->bow - bow).cwiseAbs();
    within += (off.array() <= 3 * map.bow->sigma.array()).all() ? 1 : 0;
    applied += map.bow->applied ? 1 : 0;
  }
  EXPECT_GE(within, kDraws * 95 / 100);
  EXPECT_GE(applied, kDraws * 3 / 4) << "bows of 20 um and a scan that tells";
}

TEST_F(Bow, of_a_straight_sweep_is_not_known_and_nothing_is_done) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const RefinedMap map = refine(drawn(seed, BowConfig{}.prior_mm), seed, kSweep);
    ASSERT_TRUE(map.bow);
    EXPECT_FALSE(map.bow->applied);
    EXPECT_EQ(map.bow->determined, 0);
  }
}

TEST_F(Bow, of_a_sound_rig_is_not_found) {
  constexpr int kDraws = 20;
  int applied = 0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const RefinedMap map = refine(BowVector::Zero(), 1000 + seed, kSweep + kRolled);
    ASSERT_TRUE(map.bow);
    applied += map.bow->applied ? 1 : 0;
  }
  EXPECT_LE(applied, kDraws * 5 / 100);
}

}  // namespace
}  // namespace enamel::pipeline
