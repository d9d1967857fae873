// What a person must know beside the figures of a comparison.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/compare/compare.hpp"
#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

struct Doubts {
  std::vector<std::string> words;  ///< one sentence each, in the order of the files
  bool unit = false;               ///< a size cannot be, or does not go with the other one: the figures mean nothing
  LeftOut mesh, reference;         ///< what the readers left out, summed over the references
};

/// `names`: of the mesh, then of each reference. Told: vertices and faces left out; positions so far out that the
/// file's numbers step by more than 1 um; a size that no mouth has, or that is another unit's of the other mesh's, with
/// the factor that would fit; two that do not lie on each other where nothing was asked to lay them there.
[[nodiscard]] Doubts doubts_of(const MeshFile& mesh, std::span<const MeshFile> references,
                               std::span<const std::string> names, const CompareResult& result);

/// The keys of compare_json, then `left_out` (vertices and faces of `mesh` and `reference`) and `warnings`.
[[nodiscard]] std::string compare_json(const CompareResult& result, const Doubts& doubts);

}  // namespace enamel::host
