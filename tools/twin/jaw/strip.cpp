#include "tools/twin/jaw/strip.hpp"

#include <algorithm>

#include "tools/twin/jaw/polygonise.hpp"

namespace enamel::twin {
namespace {

/// Box about the strip, by walking along its two borders.
void bound(const Strip& strip, const Arch& arch, Eigen::Vector3d& low, Eigen::Vector3d& high) {
  low = {1e9, 1e9, strip.low};
  high = {-1e9, -1e9, strip.high};
  for (double s = strip.from; s <= strip.to; s += 0.5) {
    for (const double n : {-strip.inside, strip.outside}) {
      const Eigen::Vector2d p = arch.point(s) + n * arch.buccal(s);
      low.head<2>() = low.head<2>().cwiseMin(p);
      high.head<2>() = high.head<2>().cwiseMax(p);
    }
  }
}

}  // namespace

double Strip::beyond(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const {
  return std::max({from - a.s, a.s - to, -inside - a.n, a.n - outside, back - p.y()});
}

TriSurface mesh_strip(const Strip& strip, const Arch& arch, const ArchCoordinates& coordinates,
                      const MeshLimits& limits, const std::function<double(const Eigen::Vector3d&)>& field) {
  PolygoniseConfig pc;
  pc.lipschitz = limits.lipschitz;
  pc.cell_mm = 0.7 * limits.max_edge_mm;  // diagonals of the net's quads then stay about max_edge_mm
  bound(strip, arch, pc.low, pc.high);
  const auto beyond = [&](const Eigen::Vector3d& p) { return strip.beyond(coordinates.at(p.x(), p.y()), p); };
  return polygonise(
      pc,
      [&](const Eigen::Vector3d& p) {
        // Well outside the strip nothing is kept, so nothing need be searched; the factor allows for s being stretched
        // on the inside of the curve.
        const double out = beyond(p);
        return out > 1.0 ? 0.3 * out : field(p);
      },
      [&](const Eigen::Vector3d& p) { return beyond(p) <= 0; });
}

}  // namespace enamel::twin
