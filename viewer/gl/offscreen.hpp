// A picture without any display: EGL surfaceless context and the same drawing code as the window, panels included.
#pragma once

#include "protocol/base/result.hpp"
#include "viewer/gl/picture.hpp"
#include "viewer/gl/viewer_options.hpp"
#include "viewer/scene/preview.hpp"

namespace enamel::view {

/// Size from `options` (at most 8192 x 8192). Errors: kDisplay when no surfaceless EGL with OpenGL >= 3.3 exists.
/// May be called from any thread, also while a window is open on another one; not from the window's thread.
[[nodiscard]] Result<Picture> draw_offscreen(const PreviewFrame& frame, const ViewerOptions& options);

}  // namespace enamel::view
