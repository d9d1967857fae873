// Camera rays to the surface and on to the projector: how much light one sample of a pixel brings back, and from which
// projector coordinate. Immutable after construction; queries may run on any thread.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/twin/render/optics_model.hpp"
#include "tools/twin/surface/scene_at.hpp"

namespace enamel::twin {

/// The instrument at one pose, seen from the model.
struct View {
  View(const Instrument& instrument, const Pose& T_model_cam);
  Eigen::Matrix3d R_model_cam, R_proj_cam;
  Vec3d camera, projector, t_proj_cam;  ///< centres in model coordinates
  std::span<const Guest> guests;        ///< what else stands there at that instant
};

/// A share of a sample's light that shows the pattern elsewhere, or more blurred, than at the point hit.
struct LightPart {
  double coordinate = 0;  ///< along the pattern axis, projector px
  float weight = 0;       ///< full-well fraction at emission 1
  float sigma2 = 0;       ///< blur, px²
};
/// Lobes inside, light of the surface, its mirror light, that of the film.
inline constexpr std::size_t kMaxParts = kMaxLobes + 3;

/// What one camera ray brings back, as of plaster.
struct PlainLane {
  bool hit = false, in_projector = false;
  bool faces = false;   ///< the facet is turned to the light
  bool lit = false;     ///< … and nothing stands between
  double z = 0;         ///< camera z, mm
  double u = 0, v = 0;  ///< projector coordinates
  double weight = 0;    ///< full-well fraction at emission 1
  double ambient = 0;   ///< full-well fraction
  double sigma2 = 0;    ///< projector blur, px²
  float albedo = 0;
  std::uint8_t parts = 0;  ///< of Lane::part in use: all the light then, and `weight` is 0
};
/// The parts stay as they are until they are used: they cost plaster nothing.
struct Lane : PlainLane {
  std::array<LightPart, kMaxParts> part{};
  double lamp = 0;         ///< full-well fraction of the lamp's light, flicker apart
  std::uint8_t guest = 0;  ///< 0: the mouth; else the guest's index + 1
};
using Lanes8 = std::array<Lane, kPacket>;

/// Light and shade of a pixel as far as samples traced before tell.
enum class Shade : std::uint8_t { kUnknown, kDark, kLit };

class LightTracer {
 public:
  /// Keeps references: instrument and scene must outlive the tracer.
  LightTracer(const Instrument& instrument, const RayScene& scene, const LightConfig& light);

  /// The first n <= kPacket rays of `directions` (x/z, y/z a ray, camera frame). known: one a ray, what needs no shadow
  /// ray; nullptr: nothing is known.
  void trace(const View& view, const double* directions, std::size_t n, const Shade* known, Lanes8& lanes) const;

 private:
  void light(const View& view, const Vec3d& ray_cam, const RayScene::Surfel& s, Lane& lane) const;

  const Instrument& instrument_;
  const RayScene& scene_;
  LightConfig light_;
  bool has_materials_ = false;
  double gain_ = 0;  ///< full-well fraction per albedo * cos / r^2
};

/// x/z, y/z of the rays through (x + dx[s], y + dy[s]): [row][sample][column][2].
[[nodiscard]] std::vector<double> ray_table(const Lens& lens, int width, int height, const std::vector<double>& dx,
                                            const std::vector<double>& dy);

}  // namespace enamel::twin
