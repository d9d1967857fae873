// Whether a mesh encloses a volume: the check that a closed model has to pass, and that an open one fails.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/types/mesh.hpp"

namespace enamel::host {

struct Watertight {
  std::uint64_t open_edges = 0;        ///< of one face
  std::uint64_t crowded_edges = 0;     ///< of three faces and more
  std::uint64_t turned_edges = 0;      ///< of two faces that run the same way: one of them is inside out
  std::uint64_t pinched_vertices = 0;  ///< where two fans of faces touch
  std::uint64_t flat_faces = 0;        ///< a corner named twice
  std::uint64_t pieces = 0;            ///< that no edge joins
  std::uint64_t inside_out = 0;        ///< pieces whose normals point inwards
  double volume_mm3 = 0;               ///< signed, of all pieces

  /// Every edge has two faces that run against each other, no vertex is pinched, and every piece's normals point
  /// outwards.
  [[nodiscard]] bool holds() const noexcept {
    return pieces > 0 && inside_out == 0 && open_edges + crowded_edges + turned_edges + pinched_vertices == 0 &&
           flat_faces == 0 && volume_mm3 > 0;
  }
};

/// By indices: corners of equal position are not one. Pure, thread-safe.
[[nodiscard]] Watertight check_watertight(const Mesh& mesh);

/// "12 edges of one face, 1 pinched vertex"; empty where the mesh is watertight.
[[nodiscard]] std::string leaks_text(const Watertight& check);

}  // namespace enamel::host
