// A drawn picture on its way to a file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::view {

struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< row-major, top row first, 3 bytes a pixel
  std::string drawn_by;           ///< which path drew it: "window" or "EGL surfaceless", with the GL renderer's name
};

/// Writes a PNG beside `path` and renames it, so that no half-written file is left. Errors: kFileWrite.
[[nodiscard]] Result<void> write_png(const Picture& picture, const std::string& path);

}  // namespace enamel::view
