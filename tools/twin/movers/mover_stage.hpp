// All that moves by itself in a scene, burst by burst.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "tools/twin/movers/mover_motion.hpp"
#include "tools/twin/path/trajectory.hpp"
#include "tools/twin/surface/scene_at.hpp"

namespace enamel::twin {

/// The instants of a burst at which light is gathered, seconds of the scan: frames[frame][instant], and its middle.
struct BurstInstants {
  std::array<std::vector<double>, 4> frames;
  double mid = 0;
};

/// Guests at those instants. All share the same order and the same bodies.
struct BurstGuests {
  std::array<std::vector<Guests>, 4> frames;
  Guests mid;
  std::vector<std::size_t> movers;  ///< which mover each guest is
};

class MoverStage {
 public:
  /// Keeps references to mouth and path. scan_s: length of the scan.
  MoverStage(const std::vector<MoverConfig>& movers, std::uint64_t seed, const RayScene& mouth, const Trajectory& path,
             double scan_s);

  /// Soft bodies take the form that they have at mid-burst; all move during the burst.
  [[nodiscard]] BurstGuests at(const BurstInstants& instants) const;
  [[nodiscard]] const std::vector<MoverConfig>& movers() const { return configs_; }

 private:
  std::vector<MoverConfig> configs_;
  std::vector<std::uint64_t> seeds_;
  std::vector<MoverMotion> motions_;
  std::vector<std::shared_ptr<const RayScene>> rigid_;  ///< null: soft, built for each burst
};

}  // namespace enamel::twin
