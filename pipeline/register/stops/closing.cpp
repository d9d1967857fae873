#include "pipeline/register/stops/closing.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace enamel::pipeline {
namespace {

constexpr double kSame_deg = 0.5;  // chosen: of one swing, or of one angle
constexpr std::size_t kSmallestRing = 4;

double turn_deg(const Stop& stop) {
  const double deg = std::fmod(stop.angles.rotation() * calib::kDegreesPerRad, 360);
  return deg < 0 ? deg + 360 : deg;
}

using Edges = std::map<std::pair<std::size_t, std::size_t>, const MapEdge*>;

/// Stop b in the frame of stop a by their edges, both ways; half of what these differ by is taken from each.
std::optional<Pose> by_edges(const Edges& edges, std::size_t a, std::size_t b) {
  const auto one = edges.find({b, a}), other = edges.find({a, b});
  if (one == edges.end() && other == edges.end()) return std::nullopt;
  if (one == edges.end()) return other->second->T_j_i.inverse();
  const Pose& T = one->second->T_j_i;
  if (other == edges.end()) return T;
  const Vec3d& centre = one->second->centre;
  const Vector6 x = motion_between(T, other->second->T_j_i.inverse(), centre, 1);
  return apply_motion(0.5 * x, centre, 1, T);
}

/// An arc is none, even where its ends see each other: half a turn from neighbour to neighbour leaves open which way.
bool goes_round(const std::vector<Stop>& stops, const std::vector<std::size_t>& ring) {
  constexpr double kHalfTurn_deg = 180;
  for (std::size_t n = 0; n < ring.size(); ++n) {
    const bool is_last = n + 1 == ring.size();
    const double next_deg = is_last ? turn_deg(stops[ring.front()]) + 360 : turn_deg(stops[ring[n + 1]]);
    if (next_deg - turn_deg(stops[ring[n]]) >= kHalfTurn_deg) return false;
  }
  return true;
}

/// Indices of the stops of one swing by their angle, one an angle.
std::vector<std::vector<std::size_t>> rings(const std::vector<Stop>& stops) {
  std::map<long, std::vector<std::size_t>> by_swing;
  for (std::size_t k = 0; k < stops.size(); ++k)
    by_swing[std::lround(stops[k].angles.swing() * calib::kDegreesPerRad / kSame_deg)].push_back(k);
  std::vector<std::vector<std::size_t>> out;
  for (auto& [swing, ring] : by_swing) {
    std::ranges::stable_sort(ring, {}, [&](std::size_t k) { return turn_deg(stops[k]); });
    const auto same = [&](std::size_t a, std::size_t b) { return turn_deg(stops[b]) - turn_deg(stops[a]) < kSame_deg; };
    ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());
    if (ring.size() > 1 && turn_deg(stops[ring.back()]) - 360 + kSame_deg > turn_deg(stops[ring.front()]))
      ring.pop_back();
    if (ring.size() >= kSmallestRing && goes_round(stops, ring)) out.push_back(ring);
  }
  return out;
}

double gap_mm(const Pose& T_a_b, const Vec3d& centre, const std::vector<Pose>& T_model_cam, std::size_t a,
              std::size_t b) {
  return (T_a_b * centre - T_model_cam[a].inverse() * T_model_cam[b] * centre).norm();
}

}  // namespace

double edge_gap_mm(const MapEdge& edge, const std::vector<Pose>& T_model_cam) {
  const Pose T_j_i = T_model_cam[edge.j].inverse() * T_model_cam[edge.i];
  const Vec3d in_i = edge.T_j_i.inverse() * edge.centre;
  return (T_j_i * in_i - edge.centre).norm();
}

std::vector<Circle> find_circles(const std::vector<Stop>& stops, const std::vector<MapEdge>& edges,
                                 const std::vector<Pose>& by_axes, const std::vector<Pose>& solved) {
  Edges found;
  for (const MapEdge& edge : edges) found[{edge.i, edge.j}] = &edge;
  std::vector<Circle> out;
  for (const std::vector<std::size_t>& ring : rings(stops)) {
    Pose chain = Pose::Identity();
    bool is_whole = true;
    for (std::size_t n = 0; n < ring.size() && is_whole; ++n) {
      const auto T = by_edges(found, ring[n], ring[(n + 1) % ring.size()]);
      is_whole = T.has_value();
      if (T) chain = chain * *T;
    }
    if (!is_whole) continue;
    const std::size_t first = ring.front(), last = ring.back();
    const Pose T_last_first = *by_edges(found, last, first);
    const Vec3d& centre = stops[first].centre;
    out.push_back({stops[first].angles.swing() * calib::kDegreesPerRad, ring.size(), (chain * centre - centre).norm(),
                   Eigen::AngleAxisd(chain.linear()).angle() * calib::kDegreesPerRad,
                   gap_mm(T_last_first, centre, by_axes, last, first),
                   gap_mm(T_last_first, centre, solved, last, first)});
  }
  return out;
}

}  // namespace enamel::pipeline
