// A procedural jaw: arch, teeth with cusps and fissures, gum with papillae and sulcus, palate or floor. seed ->
// patient.
#pragma once

#include <cstdint>

#include "tools/twin/jaw/fault.hpp"
#include "tools/twin/jaw/jaw_field.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct JawConfig {
  JawSide side = JawSide::kLower;
  int last_tooth = 7;       ///< 1 central incisor … 7 second molar
  bool both_sides = false;  ///< else the right quadrant only
  bool palate = false;      ///< upper only: meshed to its middle instead of the rim beside the teeth
  double max_edge_mm = 0.1;
  /// Part of the arch that is meshed, arc length; the surface is open at both ends. Equal values: all teeth.
  double from_mm = 0, to_mm = 0;
  double enamel_albedo = 0.8, gum_albedo = 0.6;
  FaultConfig fault;
};

struct Jaw {
  Dentition dentition;
  TriSurface mesh;  ///< jaw coordinates (path/arch.hpp); material: enamel and gum
};

/// moved: as it is after FaultConfig::move_at_s.
[[nodiscard]] Jaw make_jaw(const JawConfig& config, std::uint64_t seed, bool moved = false);

}  // namespace enamel::twin
