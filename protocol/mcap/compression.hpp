// Bytes of a chunk, packed and unpacked. Private to this folder. Thread-safe: no state.
#pragma once

#include <string_view>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

inline constexpr const char* kZstd = "zstd";
inline constexpr const char* kLz4 = "lz4";

/// zstd at its fastest level. Errors: kInternal.
[[nodiscard]] Result<std::vector<std::byte>> compress(ByteSpan bytes);
/// `compression` as a chunk names it; empty: stored as they are. Errors: kCaptureCorrupt when the bytes are damaged or
/// do not give exactly `size` bytes; kCaptureInvalid for a compression that is not read here, by its name.
[[nodiscard]] Result<std::vector<std::byte>> decompress(std::string_view compression, ByteSpan bytes, std::size_t size);

}  // namespace enamel::mcap
