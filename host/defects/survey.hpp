// What the bursts of a scan say about each place of its finished surface: how many saw it, from where, whether they
// agree. mm, model frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/defects/surface_cells.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/patch.hpp"
#include "pipeline/types/sight.hpp"

namespace enamel::host {

struct CellFacts {
  std::uint32_t views = 0;   ///< bursts that measured it
  float best_cos = 0;        ///< of the angle between its normal and the ray of the burst that faced it most
  float scatter_mm = 0;      ///< of their points along the normal: standard deviation
  float drift_mm = 0;        ///< by how much later bursts put it higher than earlier ones
  float drift_sigma_mm = 0;  ///< of that, by the scatter that is left
};

/// Measured points that were left out because other bursts looked through them.
struct PassedPoint {
  std::uint32_t burst = 0;  ///< number in the order of placed bursts
  Vec3f p_model = Vec3f::Zero();
};

struct SurveyResult {
  std::vector<CellFacts> facts;            ///< one a cell of cells_of(mesh)
  std::vector<std::uint32_t> glare_cells;  ///< where mirror light was seen: one for each burst with some
  std::vector<PassedPoint> passed;
  double passed_mm2 = 0;  ///< surface that one of them stands for
};

/// Bursts are added in their order. Same bursts, same bits. Not thread-safe; the mesh must outlive it.
class Survey {
 public:
  Survey(const Mesh& mesh, const calib::LensValues& camera);
  void add(const SurfacePatch& patch, const Pose& T_model_cam, const Sight& sight);
  [[nodiscard]] SurveyResult result() const;

 private:
  struct Sums {
    double n = 0, t = 0, tt = 0, r = 0, rr = 0, tr = 0, best_cos = 0;
  };
  void measure(const SurfacePatch& patch, const Pose& T_model_cam, std::uint32_t cell, int u, int v);

  const Mesh& mesh_;
  SurfaceCells cells_;
  calib::LensValues camera_;
  std::vector<Sums> sums_;
  std::vector<std::uint32_t> glare_cells_;
  std::uint32_t bursts_ = 0;
};

}  // namespace enamel::host
