// Surfaces the twin traces: triangles with per-vertex shading values, and exact balls. Model coordinates, mm.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tools/twin/surface/dot_print.hpp"
#include "tools/twin/surface/material.hpp"

namespace enamel::twin {

using Vec3f = Eigen::Vector3f;
using Vec3d = Eigen::Vector3d;

/// Saliva over a place.
struct Film {
  float thickness_mm = 0;
  float level = 0;  ///< 1: its upper side lies level (a pool), 0: it follows the surface
};

/// Triangles wind counter-clockwise seen from outside. normals and albedo have one entry a vertex.
struct TriSurface {
  std::vector<Vec3f> vertices;
  std::vector<Vec3f> normals;            ///< unit, outwards: shading only, geometry is the flat facet
  std::vector<float> albedo;             ///< diffuse reflectance 0…1, texture included
  std::vector<std::uint8_t> material{};  ///< MaterialId; empty: plaster
  std::vector<Film> film{};              ///< empty: dry
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct Ball {
  Vec3d centre = Vec3d::Zero();
  double radius = 1;
  float albedo = 0.8F;
  std::uint8_t material = 0;  ///< MaterialId
};

/// What stands before the probe.
struct Surroundings {
  TriSurface mesh;
  std::vector<Ball> balls;          ///< traced as exact spheres
  std::optional<DotPrint> print{};  ///< overrides the mesh's albedo
  MaterialTable materials{};        ///< by MaterialId
  double film_roughness = 0.05;     ///< GGX alpha of the film's upper side
};

/// Area-weighted vertex normals from the facets.
void compute_normals(TriSurface& surface);

/// Splits edges until none is longer than max_edge_mm; facets stay flat. Albedo and normals are interpolated.
void refine_edges(TriSurface& surface, double max_edge_mm);

/// Smooths the few places where facets are folded over against their neighbours: moves the vertices of such facets to
/// the mean of theirs until none is left, at most kMaxFoldRounds times. Normals are recomputed. Returns the facets
/// still folded.
std::size_t smooth_folds(TriSurface& surface);
inline constexpr int kMaxFoldRounds = 24;

/// Appends `extra` to `surface`.
void append(TriSurface& surface, const TriSurface& extra);

/// Sphere of triangles with edges up to edge_mm, vertices on the sphere.
[[nodiscard]] TriSurface tessellate(const Ball& ball, double edge_mm);

/// The truth as one mesh: the traced triangles and the balls tessellated.
[[nodiscard]] TriSurface truth_mesh(const Surroundings& surroundings, double ball_edge_mm);

}  // namespace enamel::twin
