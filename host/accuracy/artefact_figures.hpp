// How far an artefact of certified balls is from its certificate, as scanned: probing errors of form (PF) and size (PS)
// and the distances' errors (SD). Pure, thread-safe.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/accuracy/accuracy.hpp"
#include "host/accuracy/balls.hpp"
#include "pipeline/register/map/artefact.hpp"

namespace enamel::host {

struct ArtefactFigures {
  std::vector<FittedBall> balls;    ///< in the certificate's order, in the mesh's frame
  std::vector<double> form_um;      ///< PF, one a ball: range of 95 % of its radial deviations
  std::vector<double> size_um;      ///< PS, one a ball: diameter that fits best less the certified one
  std::vector<double> distance_um;  ///< SD, one a certified distance: fitted less certified
};

/// The one way to name balls found so that diameters and distances fit the certificate, within 0.1 and 0.5 mm; of two
/// ways the one that fits better. Errors: kMeshInvalid, with the run's name and which ball is not there.
[[nodiscard]] Result<ArtefactFigures> artefact_figures(const AccuracyRun& run, const pipeline::KnownArtefact& artefact,
                                                       const BallConfig& config = {});

}  // namespace enamel::host
