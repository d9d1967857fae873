// Ray queries against the surroundings, eight rays at a time. The tracer works in float; hit_depth() below redoes the
// last step in double, because a fringe coordinate good to 1e-4 px needs hits good to a few nm.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

inline constexpr std::size_t kPacket = 8;
using Lanes = std::array<float, kPacket>;

struct alignas(32) RayPacket {
  Lanes ox{}, oy{}, oz{};                                  ///< origin, model coordinates
  Lanes dx{}, dy{}, dz{};                                  ///< direction, any length
  Lanes near{}, far{};                                     ///< range of the ray parameter
  alignas(32) std::array<std::int32_t, kPacket> active{};  ///< -1 in use, 0 not
};

enum class HitKind : std::uint8_t { kNone, kTriangle, kBall };

struct HitPacket {
  std::array<HitKind, kPacket> kind{};
  std::array<std::uint32_t, kPacket> index{};  ///< triangle or ball
  Lanes u{}, v{};                              ///< barycentric weights of vertices 1 and 2
  Lanes t{};                                   ///< ray parameter, as far as float goes
  std::array<std::uint8_t, kPacket> guest{};   ///< SceneAt: 0 the mouth, else the guest's index + 1
};

/// Immutable after construction; queries may run on any thread.
class RayScene {
 public:
  explicit RayScene(Surroundings surroundings);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  void intersect(const RayPacket& rays, HitPacket& hits) const;
  /// Lane i of the result: true when something lies within the ray's range.
  void occluded(const RayPacket& rays, std::array<bool, kPacket>& blocked) const;

  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }

  /// What shading needs of a hit.
  struct Surfel {
    double t = 0;                  ///< ray parameter of the point, double precision
    Vec3d facet = Vec3d::Zero();   ///< geometric normal, unit, outwards
    Vec3d normal = Vec3d::Zero();  ///< interpolated, unit
    float albedo = 0;
    float film_mm = 0;          ///< saliva over the point
    float level = 0;            ///< Film::level
    std::uint8_t material = 0;  ///< MaterialId
  };
  /// The hit of lane i, with origin and direction in double. False when the surface is met from behind.
  [[nodiscard]] bool resolve(const HitPacket& hits, std::size_t i, const Vec3d& origin, const Vec3d& direction,
                             Surfel& out) const;

 private:
  struct Backend;
  Surroundings surroundings_;
  std::unique_ptr<Backend> backend_;
};

}  // namespace enamel::twin
