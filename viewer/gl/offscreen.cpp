#include "viewer/gl/offscreen.hpp"

#include <limits>
#include <memory>
#include <string>

#include "viewer/gl/egl_context.hpp"
#include "viewer/gl/viewer_core.hpp"

namespace enamel::view {

Result<Picture> draw_offscreen(const PreviewFrame& frame, const ViewerOptions& options) {
  constexpr int kLargest = 4096;
  if (options.width < 16 || options.height < 16 || options.width > kLargest || options.height > kLargest) {
    return fail(ErrorCode::kUsage, "picture of " + std::to_string(options.width) + " x " +
                                       std::to_string(options.height) + " px: 16 to " + std::to_string(kLargest) +
                                       " are possible");
  }
  ENAMEL_TRY_ASSIGN(const std::unique_ptr<EglContext> context, EglContext::make());
  ENAMEL_TRY_ASSIGN(const std::unique_ptr<ViewerCore> core, ViewerCore::make(options));
  DrawRequest request;
  request.width = options.width;
  request.height = options.height;
  request.quality = Quality::kFine;
  request.upload_budget_bytes = std::numeric_limits<std::size_t>::max();
  request.interactive = false;
  ENAMEL_TRY(core->draw(std::make_shared<PreviewFrame>(frame), request));
  Picture picture = core->read_picture();
  picture.drawn_by = "EGL surfaceless (OpenGL " + core->description() + ")";
  return picture;
}

}  // namespace enamel::view
