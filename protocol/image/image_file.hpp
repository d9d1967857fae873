// An image as a file on a computer's disk: suffix, length, every chunk.
#pragma once

#include <span>

#include "protocol/image/trust.hpp"

namespace enamel::image {

/// The image inside a file whose suffix and length are right. Views into `file`. Refusals as a probe would name them.
[[nodiscard]] Checked<Manifest> open_image(std::span<const std::byte> file);
/// Every chunk too, and with keys the signatures (development keys are as good as others here: the probe decides).
[[nodiscard]] Checked<Manifest> check_image_file(std::span<const std::byte> file, std::span<const TrustedKey> keys);

}  // namespace enamel::image
