// Grey PNG files of 8 or 16 bit. Private to this folder; OpenCV stays in the .cpp.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::host {

struct GreyImage {
  int width = 0;
  int height = 0;
  int bits = 8;                        ///< of storage: 8 or 16
  std::vector<std::uint8_t> pixels{};  ///< rows top-down, no padding, little endian
};

/// Errors: kFileNotFound, kFileRead, kImageInvalid (damaged, colour, other depth).
[[nodiscard]] Result<GreyImage> read_grey_png(const std::string& path);
/// Errors: kFileWrite, kImageInvalid (pixels do not fit the size).
[[nodiscard]] Result<void> write_grey_png(const std::string& path, int width, int height, int bits,
                                          std::span<const std::uint8_t> pixels);

}  // namespace enamel::host
