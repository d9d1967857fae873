// A patch as a view of the model from its own pose: the reference while the model does not yet show this place.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

/// Knows for every pixel of an ideal view which one of the patch the lens brings there. Thread-safe.
class PatchViewer {
 public:
  /// lens: of the camera that takes the patches; width, height: of these, px; stride >= 1: camera pixels a view pixel.
  PatchViewer(const calib::LensValues& lens, int width, int height, int stride);
  /// Empty where the patch has another size.
  [[nodiscard]] ModelView operator()(const SurfacePatch& patch, const Pose& T_model_cam) const;

 private:
  int width_, height_, stride_;
  Map<std::int32_t> source_;  ///< pixel of the patch, or -1
};

/// The same for a single patch.
[[nodiscard]] ModelView view_from_patch(const SurfacePatch& patch, const Pose& T_model_cam,
                                        const calib::LensValues& lens, int stride = 1);

/// The same view in another frame.
[[nodiscard]] ModelView carried_into(const Pose& T_other_model, ModelView view);

}  // namespace enamel::pipeline
