// Deviation of a measured mesh from its reference: the core of `enamel compare` and of the accuracy block of reports.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/compare/align.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "host/mesh_files/poses_csv.hpp"

namespace enamel::host {

enum class Alignment { kNone, kBest, kStart };

struct CompareConfig {
  double coverage_within_mm = 0.1;  ///< reference nearer than this to the mesh is covered
  double coverage_sample_mm = 0.2;  ///< larger reference triangles are sampled at about this distance
  double foreign_beyond_mm = 0.15;  ///< triangles with every corner farther from the reference are foreign
  double seen_at_least = 3;         ///< reference vertices with a `seen` below were not seen by the probe
};

struct CompareInput {
  Alignment alignment = Alignment::kNone;
  const std::vector<PoseRow>* estimate_poses = nullptr;  ///< both needed for kStart
  const std::vector<PoseRow>* truth_poses = nullptr;
  Vec3d mesh_origin_mm = Vec3d::Zero();         ///< MeshFile::origin_mm of the mesh
  const Pose* best_T_reference_mesh = nullptr;  ///< kBest: fitted before, and not again; as CompareResult tells it
};

/// Figures in um over the vertices of the mesh, each counted once. All of them count, also those beyond an open border
/// of the reference, where the distance is to the border: leaving them out would hide surface that should not be there.
/// Their share is stated apart.
struct CompareResult {
  double mean_abs_um = 0, median_um = 0, rms_um = 0, p95_um = 0, p99_um = 0,
         max_um = 0;  ///< median signed, others absolute
  double coverage_pct = 0;
  double beyond_border_pct = 0;
  double foreign_pct = 0;       ///< of the mesh's area: tongue, cheek, wrong orders; what is not the reference at all
  std::optional<EndError> end;  ///< with kStart
  Alignment alignment = Alignment::kNone;
  Pose T_reference_mesh = Pose::Identity();  ///< of the files' positions, their origins included
  std::vector<float> deviation_um;           ///< signed, one a vertex of the mesh, positive outside the reference
};

/// Several references are one surface (their union). Errors: kMeshInvalid (mesh or reference empty), kUsage (kStart
/// without both pose lists), kBurstNotFound (no common burst).
[[nodiscard]] Result<CompareResult> compare(const Mesh& mesh, std::span<const MeshFile> references,
                                            const CompareInput& input, const CompareConfig& config = {});

/// The keys of cli.md; what does not apply is null.
[[nodiscard]] std::string compare_json(const CompareResult& result);

}  // namespace enamel::host
