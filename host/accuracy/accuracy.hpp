// Trueness and precision of scans of one object, in the style of ISO 12836 with the words of ISO 5725-1: trueness is
// how far scans are from a reference, precision how far from each other, each after best fit. mm, deviations um. Pure
// functions, thread-safe.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host/accuracy/figures.hpp"
#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

/// A scan of the object; its frame may be any.
struct AccuracyRun {
  std::string name;
  MeshFile file;
};

/// A run laid on the reference by best fit. Every vertex counts, also those beyond an open border of the reference.
struct RunDeviation {
  DeviationFigures figures;
  double beyond_border_pct = 0;
  Pose T_reference_run = Pose::Identity();  ///< of the files' positions, their origins included
};

/// Errors: kMeshInvalid for a mesh without triangles, and for a run that does not lie on the reference after best fit.
[[nodiscard]] Result<std::vector<RunDeviation>> trueness(std::span<const AccuracyRun> runs, const MeshFile& reference);

/// One run laid on another. Vertices beyond the other's open border do not count, since no scan is the whole object:
/// how much was seen is no deviation.
struct PairDeviation {
  std::size_t first = 0, second = 0;  ///< runs; the first's vertices, the second's surface
  DeviationFigures figures;
  double beyond_border_pct = 0;
};

/// All n (n - 1) / 2 pairs; none for a single run. Errors: as trueness().
[[nodiscard]] Result<std::vector<PairDeviation>> precision(std::span<const AccuracyRun> runs);

}  // namespace enamel::host
