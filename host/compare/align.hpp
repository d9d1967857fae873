// Laying a measured mesh on its reference.
#pragma once

#include <optional>
#include <vector>

#include "host/compare/signed_surface.hpp"
#include "host/mesh_files/poses_csv.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host {

/// What is left at the far end when the first common poses are laid on each other.
struct EndError {
  double end_error_um = 0;          ///< of the point 48 mm before the camera at the last common burst
  double end_rotation_deg = 0;      ///< of the camera there
  std::optional<double> scale_ppm;  ///< best similarity of the 48-mm points, positive = estimate too large; none below
                                    ///< 3 bursts or where they span less than 1 mm
};

struct StartAlignment {
  Pose T_truth_estimate = Pose::Identity();
  EndError end;
};

/// Errors: kBurstNotFound when no burst is in both.
[[nodiscard]] Result<StartAlignment> align_start(const std::vector<PoseRow>& estimate,
                                                 const std::vector<PoseRow>& truth);

/// Rigid motion of the mesh that minimises the point-to-plane distances to the reference, outliers weighted down
/// (Welsch). Starts from `T_reference_mesh` and, if that does not fit, from the principal axes.
[[nodiscard]] Pose align_best(const Mesh& mesh, const SignedSurface& reference, const Pose& T_reference_mesh);

}  // namespace enamel::host
