// Light of materials that are more than plaster: inside the body, mirrored by its surface, through a film of saliva and
// mirrored by that.
#pragma once

#include "tools/twin/render/light_tracer.hpp"

namespace enamel::twin {

/// A point that the projector lights, model directions.
struct Struck {
  Vec3d from_camera;    ///< camera to point, mm
  Vec3d in_projector;   ///< the point in projector coordinates, mm
  Vec3d to_light;       ///< unit
  double strength = 0;  ///< full-well fraction of a white Lambert surface there that faces the light
};
struct Look {
  const RayScene::Surfel& surfel;
  const Material& material;
  double film_roughness = 0;  ///< GGX alpha of the film's upper side
};

/// Sets the parts of `lane`, whose weight holds the whole light as of plaster, and clears that weight. u, v and z stay
/// those of the solid surface on the straight ray.
void split_light(const Instrument& instrument, const View& view, const Struck& struck, const Look& look, Lane& lane);

}  // namespace enamel::twin
