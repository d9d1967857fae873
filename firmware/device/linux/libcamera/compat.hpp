// Where libcamera's versions differ, 0.0.3 of Debian 12 to 0.7: asked of the headers themselves, not of a version
// number, for distributions patch. Included by .cpp files of this folder only.
#pragma once

#include <libcamera/libcamera.h>

#include "firmware/hal/camera.hpp"

namespace enamel::fw::compat {

/// FrameStartup came with 0.5. A template, so that the name is only looked up where it is.
template <class Metadata>
[[nodiscard]] FrameStatus frame_status(const Metadata& metadata) {
  if constexpr (requires { Metadata::FrameStartup; }) {
    if (metadata.status == Metadata::FrameStartup) return FrameStatus::kStartup;
  }
  switch (metadata.status) {
    case Metadata::FrameSuccess:
      return FrameStatus::kSuccess;
    case Metadata::FrameCancelled:
      return FrameStatus::kCancelled;
    default:
      return FrameStatus::kError;
  }
}

}  // namespace enamel::fw::compat
