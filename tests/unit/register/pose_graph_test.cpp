// The graph behind the map: noise is averaged over loops, a false loop is switched off, weak directions say nothing.
#include "pipeline/register/map/pose_graph.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr int kPerPass = 24;
constexpr int kPasses = 3;

/// Passes to and fro along a half circle of 25 mm radius, the camera looking at its middle line.
std::vector<Pose> arch() {
  std::vector<Pose> out;
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int k = 0; k < kPerPass; ++k) {
      const int along = pass % 2 == 0 ? k : kPerPass - 1 - k;
      const double angle = std::numbers::pi * along / (kPerPass - 1);
      Pose T = Pose::Identity();
      T.translation() = Vec3d(25 * std::cos(angle), 25 * std::sin(angle), -48);
      T.linear() = Eigen::AngleAxisd(angle, Vec3d::UnitZ()).toRotationMatrix();
      out.push_back(T);
    }
  }
  return out;
}

Vector6 noise(std::uint64_t key, double scale) {
  Vector6 x;
  for (int k = 0; k < 6; ++k) x[k] = scale * ts::normal(6 * key + static_cast<std::uint64_t>(k));
  return x;
}

struct Scan {
  std::vector<Pose> truth = arch();
  std::vector<Pose> tracked;
  std::vector<MapEdge> edges;
};

MapEdge edge(const std::vector<Pose>& truth, std::size_t i, std::size_t j, std::uint64_t key) {
  MapEdge out;
  out.i = i, out.j = j;
  out.centre = Vec3d(0, 0, 48);
  out.T_j_i = apply_motion(noise(key, 3e-4), out.centre, 4.5, truth[j].inverse() * truth[i]);
  out.H = 1e7 * Matrix6::Identity();
  out.loop = i > j + 1 || j > i + 1;
  return out;
}

/// Edges between all that look at points nearer than 9 mm, and poses that tracking let drift.
Scan scan(std::uint64_t seed = 0) {
  const std::uint64_t own = 1'000'000 * seed;
  Scan out;
  const std::vector<Pose>& truth = out.truth;
  const Vec3d work(0, 0, 48);
  out.tracked = {truth[0]};
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose step = apply_motion(noise(own + 9000 + i, 3e-4), work, 4.5, truth[i - 1].inverse() * truth[i]);
    out.tracked.push_back(out.tracked.back() * step);
    for (std::size_t j = 0; j < i; ++j) {
      if ((truth[i] * work - truth[j] * work).norm() < 9) out.edges.push_back(edge(truth, i, j, own + 100 * i + j));
    }
  }
  return out;
}

/// Mean distance of what is looked at from where it is, mm; node 0 is the same in both.
double error_mm(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double sum = 0;
  for (std::size_t k = 0; k < poses.size(); ++k)
    sum += (poses[k] * Vec3d(0, 0, 48) - truth[k] * Vec3d(0, 0, 48)).norm();
  return sum / static_cast<double>(poses.size());
}

/// Says that the first and the last tooth are the same: two ends of the arch, 50 mm apart.
void add_false_loop(Scan& of) {
  MapEdge lie = edge(of.truth, kPerPass - 1, 0, 77);
  lie.T_j_i = Pose(Eigen::Translation3d(0.3, 0, 0));
  of.edges.push_back(lie);
}

TEST(PoseGraph, loops_between_passes_bring_the_drift_down) {
  const Scan s = scan();
  const SolvedGraph solved = solve_graph(s.tracked, s.edges, {});
  EXPECT_LT(error_mm(solved.poses, s.truth), 0.5 * error_mm(s.tracked, s.truth));
  EXPECT_EQ(solved.switched_off, 0);
  EXPECT_TRUE(solved.poses[0].isApprox(s.tracked[0])) << "the model's frame stays";
}

TEST(PoseGraph, one_false_loop_is_switched_off_and_does_no_harm) {
  Scan s = scan();
  const SolvedGraph clean = solve_graph(s.tracked, s.edges, {});
  add_false_loop(s);
  const SolvedGraph solved = solve_graph(s.tracked, s.edges, {});
  EXPECT_EQ(solved.switched_off, 1);
  EXPECT_LT(solved.switches.back(), 1e-3);
  EXPECT_LT(error_mm(solved.poses, s.truth), 1.2 * error_mm(clean.poses, s.truth));
  GraphConfig trusting;
  trusting.switch_sigmas = 1e9;
  EXPECT_GT(error_mm(solve_graph(s.tracked, s.edges, trusting).poses, s.truth), 10 * error_mm(clean.poses, s.truth))
      << "negative control: without the switch";
}

TEST(PoseGraph, a_direction_that_the_surface_does_not_hold_has_no_say) {
  const std::vector<Pose> truth{Pose::Identity(), Pose(Eigen::Translation3d(2, 0, 0))};
  MapEdge sliding = edge(truth, 1, 0, 1);
  sliding.H(3, 3) = 1;  // along x a shift changes nothing
  sliding.T_j_i.translation().x() += 0.5;
  const SolvedGraph solved = solve_graph(truth, {sliding}, {});
  EXPECT_LT((solved.poses[1].translation() - truth[1].translation()).norm(), 0.01) << "stays where tracking had it";
  sliding.H(3, 3) = 1e7;
  EXPECT_GT((solve_graph(truth, {sliding}, {}).poses[1].translation() - truth[1].translation()).norm(), 0.4);
}

/// Of the distance between what the first pass's ends look at: its error in its own sigmas, rms over scans.
double error_in_sigmas(const GraphConfig& config) {
  const Vec3d work(0, 0, 48);
  double sum = 0;
  constexpr int kScans = 40;
  for (int seed = 1; seed <= kScans; ++seed) {
    const Scan s = scan(static_cast<std::uint64_t>(seed));
    const SolvedGraph solved = solve_graph(s.tracked, s.edges, config);
    const std::size_t a = 0, b = kPerPass - 1;
    const Vec3d pa = solved.poses[a] * work, pb = solved.poses[b] * work;
    const double error = (pa - pb).norm() - (s.truth[a] * work - s.truth[b] * work).norm();
    const double sigmas = error / solved.covariance->sigma_of_distance_mm({a, pa}, {b, pb});
    sum += sigmas * sigmas;
  }
  return std::sqrt(sum / kScans);
}

TEST(PoseGraph, a_distance_is_off_by_as_much_as_its_sigma_says) {
  GraphConfig independent;
  independent.edges_share_errors = false;
  const double rms = error_in_sigmas(independent);
  EXPECT_GT(rms, 0.7) << "forty draws: 0.78 to 1.22 in 95 of 100";
  EXPECT_LT(rms, 1.3);
  EXPECT_LT(error_in_sigmas({}), 0.5) << "edges that may share their errors promise less";
}

TEST(PoseGraph, what_nothing_holds_has_a_sigma_to_match) {
  const std::vector<Pose> truth{Pose::Identity(), Pose(Eigen::Translation3d(2, 0, 0))};
  MapEdge sliding = edge(truth, 1, 0, 1);
  const Vec3d from(0, 0, 48), to(2, 0, 48);
  EXPECT_LT(solve_graph(truth, {sliding}, {}).covariance->sigma_of_distance_mm({0, from}, {1, to}), 0.01);
  sliding.H(3, 3) = 1;  // along x a shift changes nothing
  EXPECT_GT(solve_graph(truth, {sliding}, {}).covariance->sigma_of_distance_mm({0, from}, {1, to}), 1);
}

TEST(PoseGraph, what_no_edge_holds_stays_and_nothing_at_all_is_no_error) {
  Scan s = scan();
  s.tracked.push_back(Pose(Eigen::Translation3d(500, 0, 0)));
  const SolvedGraph solved = solve_graph(s.tracked, s.edges, {});
  EXPECT_TRUE(solved.poses.back().isApprox(s.tracked.back()));
  EXPECT_TRUE(solve_graph({}, {}, {}).poses.empty());
  EXPECT_EQ(solve_graph({Pose::Identity()}, {}, {}).poses.size(), 1U);
}

}  // namespace
}  // namespace enamel::pipeline
