// A picture without any display: EGL surfaceless context and the same drawing code as the window, panels included.
#pragma once

#include "pipeline/types/preview.hpp"
#include "protocol/base/result.hpp"
#include "viewer/gl/picture.hpp"
#include "viewer/gl/viewer_options.hpp"

namespace enamel::view {

/// Size from `options` (16 to 4096 px a side). Errors: kUsage (size), kDisplay when no surfaceless EGL with OpenGL
/// >= 3.3 exists. May be called from any thread that has no GL context current (while a window is open use its
/// screenshot()); one call at a time.
[[nodiscard]] Result<Picture> draw_offscreen(const PreviewFrame& frame, const ViewerOptions& options);

}  // namespace enamel::view
