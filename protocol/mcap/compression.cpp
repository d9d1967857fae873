#include "protocol/mcap/compression.hpp"

#include <zstd.h>

namespace enamel::mcap {

// Sensor noise leaves little to find: higher levels cost several times as long for a few per cent.
constexpr int kLevel = 1;

Result<std::vector<std::byte>> compress(ByteSpan bytes) {
  std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
  const std::size_t n = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(n) != 0) return fail(ErrorCode::kInternal, std::string("zstd: ") + ZSTD_getErrorName(n));
  out.resize(n);
  return out;
}

Result<std::vector<std::byte>> decompress(ByteSpan bytes, std::size_t size) {
  std::vector<std::byte> out(size);
  const std::size_t n = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(n) != 0) return fail(ErrorCode::kCaptureCorrupt, std::string("zstd: ") + ZSTD_getErrorName(n));
  if (n != size) return fail(ErrorCode::kCaptureCorrupt, "chunk is shorter than its header says");
  return out;
}

}  // namespace enamel::mcap
