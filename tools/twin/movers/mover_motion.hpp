// When a body that moves by itself is there, and where: visits spread over the scan by the seed.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "tools/twin/movers/mover_shape.hpp"

namespace enamel::twin {

using Pose = Eigen::Isometry3d;

struct LookedAt {
  /// T_model_place: origin on the surface, x along the teeth, z towards the probe, y outwards.
  std::function<Pose(double t_s)> place;
  /// Where that is about, smooth in time.
  std::function<Vec3d(double t_s)> way;
};

class MoverMotion {
 public:
  MoverMotion(const MoverConfig& config, std::uint64_t seed, double scan_s, LookedAt looked_at);

  /// T_model_mover; none while it is away.
  [[nodiscard]] std::optional<Pose> at(double t_s) const;
  [[nodiscard]] Bend bend(double t_s) const;

 private:
  struct Wave {
    double amplitude, omega, phase;
    [[nodiscard]] double at(double t_s) const;
  };
  struct Visit {
    double begin_s, end_s;  ///< with the ways in and out
    Pose T_model_place = Pose::Identity();
    double side = 1;  ///< y of where it comes from: 1 outwards, -1 inwards
    double yaw_rad = 0, reach_mm = 0, depth_mm = 0;
    std::array<Wave, 6> wobble{};  ///< x, y, z in mm, then about them in rad
  };
  [[nodiscard]] Visit draw_visit(std::uint64_t number, double begin_s, double end_s) const;

  MoverConfig config_;
  std::uint64_t seed_;
  LookedAt looked_at_;
  std::vector<Visit> visits_;
  std::array<Wave, 2> bend_{};
};

}  // namespace enamel::twin
