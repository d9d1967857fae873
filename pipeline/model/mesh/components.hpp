// Connected pieces of a mesh.
#pragma once

#include <cstdint>
#include <span>

#include "pipeline/types/mesh.hpp"

namespace enamel::pipeline {

struct ComponentStats {
  std::uint32_t components = 0;  ///< before
  std::uint32_t removed = 0;
  std::uint64_t triangles_removed = 0;
};

/// The bursts that measured the surface about a vertex, first to last.
struct SeenSpan {
  std::uint64_t first = 0, last = 0;
};

struct ComponentRules {
  std::uint32_t min_triangles = 0;      ///< smaller pieces go
  std::uint32_t passing_triangles = 0;  ///< as do smaller ones than this, unless they are the largest …
  std::uint32_t passing_bursts = 0;     ///< … that were seen within no more bursts than this: a body that passed
};

/// Removes pieces (triangles connected through shared vertices) by the rules, and vertices that no triangle uses. Keeps
/// the order of the rest. seen: one a vertex, or empty where nothing is known of time.
ComponentStats remove_small_components(Mesh& mesh, const ComponentRules& rules, std::span<const SeenSpan> seen = {});

}  // namespace enamel::pipeline
