// A known artefact in the mouth: balls beside the teeth on a thin bar, their distances certified.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/twin/path/arch.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct SphereBarConfig {
  std::vector<double> arc_mm;             ///< where along the arch the balls lie, from the midline; empty: no bar
  std::vector<double> diameters_mm{3.0};  ///< one a ball, or one for all
  double offset_mm = -6.5;                ///< of the centres from the arch, outwards; negative: over tongue or palate
  double height_mm = 5.5;                 ///< of the centres above the gum margin
  double rod_diameter_mm = 1.0;           ///< straight from each ball to the next; 0: none
  double albedo = 0.8;
  double sigma_um = 2.5;  ///< standard deviation of a certified distance, drawn by the seed
};

struct SphereBar {
  std::vector<Ball> balls;
  TriSurface rods;
  std::string certificate_json;  ///< diameters, and every distance as a laboratory would certify it
};

/// Sizes of arc_mm and diameters_mm fit.
[[nodiscard]] SphereBar make_sphere_bar(const SphereBarConfig& config, const ArchShape& shape, std::uint64_t seed);

}  // namespace enamel::twin
