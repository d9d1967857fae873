// Saliva on a surface: a thin film in patches, pools in what is narrow, bubbles. Model z is up and occlusal.
#pragma once

#include <cstdint>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct FilmConfig {
  double wet_share = 0;      ///< of the surface, by vertices
  double thickness_um = 80;  ///< of the film where it is whole: 70 … 100 um (Collins, Dawes 1987)
  double pools_mm = 0;       ///< fissures and pits are filled so far above their bottom; 0: no pools
  int bubbles = 0;           ///< on the film
  double roughness = 0.05;   ///< GGX alpha of its upper side. chosen: by judgement, a liquid that the breath stirs

  [[nodiscard]] bool is_dry() const { return wet_share <= 0 && pools_mm <= 0; }
};

/// Sets surface.film, and material and albedo of the bubbles' rims.
void add_film(TriSurface& surface, const FilmConfig& config, const MaterialTable& materials, std::uint64_t seed);

}  // namespace enamel::twin
