// A known artefact in the map: its balls are named or it is told why not, and its distances straighten a bent arch.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pipeline/register/map/artefact_match.hpp"
#include "pipeline/register/map/artefact_tie.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr int kNodes = 40;

/// Along a half circle of 25 mm radius, the camera looking down on its middle line.
std::vector<Pose> half_circle() {
  std::vector<Pose> out;
  for (int k = 0; k < kNodes; ++k) {
    const double angle = std::numbers::pi * k / (kNodes - 1);
    Pose T = Pose::Identity();
    T.translation() = Vec3d(25 * std::cos(angle), 25 * std::sin(angle), -48);
    T.linear() = Eigen::AngleAxisd(angle, Vec3d::UnitZ()).toRotationMatrix();
    out.push_back(T);
  }
  return out;
}

/// Four balls beside the arch: where the bent one's ends, and two in front.
const std::vector<Vec3d> kBalls{{24, 1, 0}, {15, 17, 1}, {-11, 20, 0}, {-23, 2, 1}};

KnownArtefact certificate(double sigma_mm = 0.002) {
  KnownArtefact out{{3, 3, 3, 3}, {}};
  for (std::size_t i = 0; i < kBalls.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) out.distances.push_back({j, i, (kBalls[i] - kBalls[j]).norm(), sigma_mm});
  }
  return out;
}

struct BentArch {
  std::vector<Pose> truth = half_circle();
  std::vector<MapEdge> edges;
  std::vector<std::vector<FoundSphere>> seen;
  SolvedGraph solved;
};

/// Links whose every turn is off to the same side: what no loop of such links could show. bias 2e-4: 8 mrad in all.
BentArch bent_arch(double bias_rad, double noise_mm = 3e-4) {
  BentArch out;
  const std::vector<Pose>& truth = out.truth;
  std::vector<Pose> tracked{truth[0]};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    for (std::size_t back = 1; back <= std::min<std::size_t>(i, 3); ++back) {
      MapEdge edge;
      edge.i = i, edge.j = i - back;
      edge.centre = Vec3d(0, 0, 48);
      Vector6 x;
      for (int k = 0; k < 6; ++k) x[k] = noise_mm * ts::normal(600 * i + 6 * back + static_cast<std::uint64_t>(k));
      x[2] += 4.5 * bias_rad * static_cast<double>(back);
      edge.T_j_i = apply_motion(x, edge.centre, 4.5, truth[edge.j].inverse() * truth[i]);
      edge.H = 1e7 * Matrix6::Identity();
      out.edges.push_back(edge);
      if (back == 1) tracked.push_back(tracked.back() * edge.T_j_i);
    }
  }
  out.seen.resize(truth.size());
  for (std::size_t k = 0; k < truth.size(); ++k) {
    for (const Vec3d& ball : kBalls) {
      const Vec3d at = truth[k].inverse() * ball;
      if (at.head<2>().norm() > 8) continue;
      FoundSphere found;
      found.radius_mm = 1.5;
      found.covariance = 1e-6 * Eigen::Matrix3d::Identity();
      for (int d = 0; d < 3; ++d)
        found.centre[d] = at[d] + 1e-3 * ts::normal(9000 + 97 * k + 3 * static_cast<std::uint64_t>(d));
      out.seen[k].push_back(found);
    }
  }
  out.solved = solve_graph(std::move(tracked), out.edges, {});
  return out;
}

double end_error_mm(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  return ts::point_error_mm(poses.back(), truth.back());
}

ArtefactFacts tie(BentArch& scan, const KnownArtefact& artefact) {
  return tie_to_artefact(scan.seen, scan.edges, {artefact, {}, {}}, scan.solved);
}

TEST(Artefact, straightens_an_arch_that_every_link_bends) {
  BentArch scan = bent_arch(5e-5);
  const double before = end_error_mm(scan.solved.poses, scan.truth);
  const ArtefactFacts facts = tie(scan, certificate());
  ASSERT_TRUE(facts.used) << facts.why;
  EXPECT_GT(before, 0.03);
  EXPECT_LT(end_error_mm(scan.solved.poses, scan.truth), 0.5 * before) << "the last node lies beyond the last ball";
  EXPECT_GT(facts.edge_variance, 10) << "links are less sure than they look";
  ASSERT_EQ(facts.distances.size(), 6U);
  for (const auto& d : facts.distances) {
    EXPECT_TRUE(d.held);
    EXPECT_NEAR(d.after_mm, d.certified.mm, 0.006);
  }
  for (const std::size_t count : facts.seen) EXPECT_GE(count, 3U);
}

TEST(Artefact, leaves_a_good_map_as_it_is) {
  BentArch scan = bent_arch(0, 1e-4);
  const double before = end_error_mm(scan.solved.poses, scan.truth);
  ASSERT_TRUE(tie(scan, certificate()).used);
  EXPECT_LT(end_error_mm(scan.solved.poses, scan.truth), before + 0.002);
}

TEST(Artefact, a_wrong_distance_is_told_and_not_obeyed) {
  BentArch scan = bent_arch(0);
  const std::vector<Pose> before = scan.solved.poses;
  KnownArtefact wrong = certificate();
  wrong.distances[3].mm += 1;
  const ArtefactFacts facts = tie(scan, wrong);
  EXPECT_FALSE(facts.used);
  EXPECT_NE(facts.why.find("contradict"), std::string::npos) << facts.why;
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_EQ(scan.solved.poses[k].matrix(), before[k].matrix());
}

TEST(Artefact, no_balls_or_one_ball_change_nothing) {
  BentArch scan = bent_arch(0);
  const std::vector<Pose> before = scan.solved.poses;
  for (std::size_t k = 5; k < scan.seen.size(); ++k) scan.seen[k].clear();
  EXPECT_FALSE(tie(scan, certificate()).used);
  for (auto& seen : scan.seen) seen.clear();
  const ArtefactFacts facts = tie(scan, certificate());
  EXPECT_FALSE(facts.used);
  EXPECT_NE(facts.why.find("0 spheres seen"), std::string::npos) << facts.why;
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_EQ(scan.solved.poses[k].matrix(), before[k].matrix());
}

std::vector<BallCluster> clusters_at(const std::vector<Vec3d>& at, double radius = 1.5) {
  std::vector<BallCluster> out;
  for (const Vec3d& p : at) out.push_back({p, radius, {}});
  return out;
}

TEST(ArtefactMatch, names_balls_in_any_order_and_without_some_of_them) {
  const Pose moved(Eigen::Translation3d(3, 4, 5) * Eigen::AngleAxisd(1, Vec3d(1, 2, 3).normalized()));
  const BallMatch match =
      match_balls(clusters_at({moved * kBalls[2], moved * kBalls[0], moved * kBalls[3]}), certificate(), 0.3);
  EXPECT_EQ(match.sphere, (std::vector<std::size_t>{2, 0, 3})) << match.why;
}

TEST(ArtefactMatch, what_could_be_named_in_two_ways_is_not_named) {
  KnownArtefact isosceles{{3, 3, 3}, {{0, 1, 30.0, 0.002}, {0, 2, 30.2, 0.002}, {1, 2, 40, 0.002}}};
  const std::vector<Vec3d> at{{0, 0, 0}, {30.1, 0, 0}, {3.54, 29.89, 0}};
  EXPECT_NE(match_balls(clusters_at(at), isosceles, 0.3).why.find("more than one way"), std::string::npos);
  isosceles.distances[1].mm = 30.0;
  EXPECT_EQ(match_balls(clusters_at(at), isosceles, 0.3).sphere.size(), 3U) << "both ways tie alike";
}

TEST(ArtefactMatch, an_artefact_that_moved_or_another_one_is_told) {
  std::vector<Vec3d> at = kBalls;
  at.emplace_back(0, 0, 5);
  EXPECT_NE(match_balls(clusters_at(at), certificate(), 0.3).why.find("more than certified"), std::string::npos);
  at = kBalls;
  at[1].x() += 0.5;
  EXPECT_NE(match_balls(clusters_at(at), certificate(), 0.3).why.find("contradict"), std::string::npos);
  EXPECT_NE(match_balls(clusters_at(kBalls, 1.6), certificate(), 0.3).why.find("diameters"), std::string::npos);
}

TEST(ArtefactMatch, sightings_of_one_place_are_one_ball) {
  std::vector<std::vector<FoundSphere>> seen(3);
  FoundSphere ball;
  ball.radius_mm = 1.5;
  for (std::size_t k = 0; k < 3; ++k) {
    ball.centre = Vec3d(0.05 * static_cast<double>(k), 0, 48);
    seen[k].push_back(ball);
    ball.centre.x() += 5;
    seen[k].push_back(ball);
  }
  const auto clusters = cluster_balls(seen, std::vector<Pose>(3, Pose::Identity()), 0.5);
  ASSERT_EQ(clusters.size(), 2U);
  EXPECT_EQ(clusters[0].seen.size(), 3U);
  EXPECT_NEAR(clusters[0].centre.x(), 0.05, 1e-12);
}

}  // namespace
}  // namespace enamel::pipeline
