// zstd behind values. Private to this folder.
#pragma once

#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

inline constexpr const char* kZstd = "zstd";

/// Errors: kInternal (out of memory inside the library).
[[nodiscard]] Result<std::vector<std::byte>> compress(ByteSpan bytes);
/// Errors: kCaptureCorrupt unless the result has exactly `size` bytes.
[[nodiscard]] Result<std::vector<std::byte>> decompress(ByteSpan bytes, std::size_t size);

}  // namespace enamel::mcap
