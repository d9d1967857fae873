// Stations lie where their shares of the way are, whatever passes the hand took, and their distances carry a sigma.
#include "pipeline/register/map/stations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

namespace enamel::pipeline {
namespace {

const Vec3d kWork(0, 0, 48);

struct Line {
  std::vector<Pose> poses;
  std::vector<MapEdge> edges;
  std::vector<std::size_t> bursts;
};

/// There and back along x, 0 … 60 mm, from the middle: a scan need not begin at an end.
Line line() {
  Line out;
  std::vector<double> x;
  for (int k = 30; k <= 60; k += 2) x.push_back(k);
  for (int k = 60; k >= 0; k -= 2) x.push_back(k);
  for (const double at : x) out.poses.emplace_back(Eigen::Translation3d(at, 0, 0));
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (std::abs(x[i] - x[j]) > 4.5) continue;
      MapEdge edge;
      edge.i = i, edge.j = j;
      edge.T_j_i = out.poses[j].inverse() * out.poses[i];
      edge.centre = kWork;
      edge.H = 1e7 * Matrix6::Identity();
      edge.loop = i > j + 1;
      out.edges.push_back(edge);
    }
  }
  out.bursts.resize(x.size());
  std::iota(out.bursts.begin(), out.bursts.end(), std::size_t{100});
  return out;
}

TEST(Stations, lie_at_their_shares_of_the_way_from_end_to_end) {
  const Line l = line();
  const SolvedGraph solved = solve_graph(l.poses, l.edges, {});
  const Stations found = find_stations(solved, l.edges, l.bursts, kWork, 15);
  EXPECT_NEAR(found.way_mm, 60, 0.01) << "two passes over one place are one way";
  ASSERT_EQ(found.stations.size(), kStationShares.size());
  for (const Station& s : found.stations) {
    const double from_an_end = std::min(s.p_model.x(), 60 - s.p_model.x());
    EXPECT_NEAR(from_an_end, 60 * std::min(s.share, 1 - s.share), 1.01);
    EXPECT_EQ(s.burst, 100 + s.node);
  }
  ASSERT_EQ(found.distances.size(), 6U);
  for (const StationDistance& d : found.distances) {
    const Vec3d apart = found.stations[d.a].p_model - found.stations[d.b].p_model;
    EXPECT_NEAR(d.distance_mm, apart.norm(), 1e-9);
    EXPECT_GT(d.sigma_mm, kSurfaceSigma_mm);
  }
  EXPECT_GT(found.distances[2].sigma_mm, found.distances[0].sigma_mm)
      << "from end to end less surely than beside each other";
}

/// Once along a half circle of 20 mm radius; its ends are 40 mm apart, 63 mm along the way.
Line bent_line() {
  Line out;
  constexpr std::size_t kBent = 33;
  for (std::size_t k = 0; k < kBent; ++k) {
    const double angle = std::numbers::pi * static_cast<double>(k) / (kBent - 1);
    out.poses.emplace_back(Eigen::Translation3d(20 * std::cos(angle), 20 * std::sin(angle), 0));
    if (k == 0) continue;
    MapEdge edge;
    edge.i = k, edge.j = k - 1;
    edge.T_j_i = out.poses[k - 1].inverse() * out.poses[k];
    edge.centre = kWork;
    edge.H = 1e7 * Matrix6::Identity();
    out.edges.push_back(edge);
  }
  out.bursts.resize(kBent);
  return out;
}

TEST(Stations, a_false_loop_that_was_switched_off_is_no_short_cut) {
  Line l = bent_line();
  SolvedGraph solved = solve_graph(l.poses, l.edges, {});
  l.edges.push_back(l.edges.front());
  l.edges.back().i = l.poses.size() - 1;  // told to lie beside the first
  l.edges.back().j = 0;
  solved.switches.push_back(0);  // as PoseGraph leaves a false loop
  EXPECT_NEAR(find_stations(solved, l.edges, l.bursts, kWork, 15).way_mm, 62.8, 0.2);
  solved.switches.back() = 1;
  EXPECT_LT(find_stations(solved, l.edges, l.bursts, kWork, 15).way_mm, 55) << "negative control";
}

TEST(Stations, a_short_scan_has_none) {
  const Line l = line();
  const SolvedGraph solved = solve_graph(l.poses, l.edges, {});
  EXPECT_TRUE(find_stations(solved, l.edges, l.bursts, kWork, 61).stations.empty());
  EXPECT_TRUE(find_stations({}, {}, {}, kWork, 15).stations.empty());
}

}  // namespace
}  // namespace enamel::pipeline
