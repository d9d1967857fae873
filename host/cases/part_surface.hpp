// The scanned surface of one part of a case, ready to be laid on another's.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/compare/triangle_tree.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host {

/// A piece of surface about as wide as its list's pitch.
struct SurfaceElement {
  Vec3d point = Vec3d::Zero(), normal = Vec3d::Zero();  ///< mm; unit
  double area_mm2 = 0;
};

/// Immutable after construction; thread-safe.
class PartSurface {
 public:
  /// `mesh` has triangles, and shares the vertices of neighbours.
  explicit PartSurface(Mesh mesh);
  PartSurface(const PartSurface&) = delete;
  PartSurface& operator=(const PartSurface&) = delete;

  struct Hit {
    Vec3d point = Vec3d::Zero(), normal = Vec3d::Zero();  ///< the nearest point; unit, of the surface round about it
    bool border = false;                                  ///< what goes on there was not scanned
  };
  /// Nothing where the surface is farther than within_mm.
  [[nodiscard]] std::optional<Hit> nearest(const Vec3d& p, double within_mm) const;

  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }                             ///< with normals
  [[nodiscard]] const std::vector<SurfaceElement>& fine() const noexcept { return fine_; }      ///< 0.2 mm
  [[nodiscard]] const std::vector<SurfaceElement>& coarse() const noexcept { return coarse_; }  ///< 0.9 mm

 private:
  Mesh mesh_;
  TriangleTree tree_;
  std::vector<bool> on_border_;  ///< of vertices
  std::vector<SurfaceElement> fine_, coarse_;
};

}  // namespace enamel::host
