// Table and holder, so that they can be taken out of a scan: what an empty table showed, or a plane above it.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "calib/model/mount.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct ReliefConfig {
  double reach_mm = 45;    ///< from the rotation axis
  double cell_mm = 0.5;    ///< of the relief
  double margin_mm = 0.3;  ///< above it, everything goes: chosen, what a slope rises within half a cell
};

/// Heights over a plane square to the rotation axis, in the model's frame (both axes at zero): 0 where the rotation
/// axis passes the swing axis, more towards the camera.
class TableRelief {
 public:
  /// `above_mm`: everything lower goes; none: nothing, until add().
  TableRelief(const calib::Mount& mount, const ReliefConfig& config, std::optional<double> above_mm = std::nullopt);

  /// Of a stop of the empty table.
  void add(const SurfacePatch& patch, const Pose& T_model_cam);
  [[nodiscard]] bool empty() const noexcept { return !above_mm_ && cells_ == 0; }

  /// Takes out what lies at or below the relief, and returns how many pixels that are.
  std::size_t take_out(const Pose& T_model_cam, SurfacePatch& patch) const;

  [[nodiscard]] double height_mm(const Vec3d& p_model) const;

 private:
  [[nodiscard]] std::optional<std::size_t> cell_of(const Vec3d& p_model) const;

  ReliefConfig config_;
  std::optional<double> above_mm_;
  Vec3d point_, up_, e1_, e2_;
  int side_;                   ///< cells
  std::vector<float> top_mm_;  ///< highest of each cell; lowest() where nothing was seen
  std::size_t cells_ = 0;      ///< that were seen
};

}  // namespace enamel::pipeline
