// Whether two frames are shown alike: the second need not be drawn.
#pragma once

#include "pipeline/types/preview.hpp"

namespace enamel::view {

/// Maps, models and figures are alike where they are the same objects. Thread-safe.
[[nodiscard]] bool same_picture(const PreviewFrame& a, const PreviewFrame& b);

}  // namespace enamel::view
