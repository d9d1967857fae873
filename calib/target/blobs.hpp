// Bright or dark round spots of an image. Private to calib/target.
#pragma once

#include <vector>

#include "calib/target/disc_fit.hpp"

namespace enamel::calib {

struct Blob {
  Ellipse ellipse;
  bool has_hole = false;  ///< a ring
};

/// Elliptic spots of like size that do not touch the border, in raster order of their outlines.
[[nodiscard]] std::vector<Blob> find_blobs(const Map<float>& image, bool bright);

}  // namespace enamel::calib
