// What dentists left in a mouth and what else its teeth are like: materials of the vertices of a jaw.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/twin/jaw/dentition.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// Teeth by number: 1 central incisor … 7 second molar of the right quadrant, negative on the left.
struct MouthConfig {
  std::vector<double> metal_crowns, ceramic;  ///< whole crowns
  std::vector<double> amalgam;                ///< a filling in the biting surface
  std::vector<double> stained, dark;          ///< whole crowns
  std::vector<double> dentine;                ///< necks laid bare
  std::vector<double> blood_mm;               ///< arc length of spots at the gum margin
};

/// Number of each tooth of `dentition`, in its order.
[[nodiscard]] std::vector<int> tooth_numbers(const Dentition& dentition);

/// Materials beyond enamel and gum, and the albedo that goes with each; mesh.material is set.
void dress_mouth(TriSurface& mesh, const Dentition& dentition, const MouthConfig& config,
                 const MaterialTable& materials, std::uint64_t seed);

}  // namespace enamel::twin
