#include "protocol/mcap/compression.hpp"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>

namespace enamel::mcap {
namespace {

// Sensor noise leaves little to find: higher levels cost several times as long for a few per cent.
constexpr int kLevel = 1;

using Bytes = std::vector<std::byte>;

tl::unexpected<Error> damaged(const char* library, const char* what) {
  return fail(ErrorCode::kCaptureCorrupt, std::string(library) + ": " + what);
}

Result<Bytes> from_zstd(ByteSpan bytes, std::size_t size) {
  Bytes out(size);
  const std::size_t n = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(n) != 0) return damaged(kZstd, ZSTD_getErrorName(n));
  if (n != size) return damaged(kZstd, "chunk is shorter than its header says");
  return out;
}

// The frame format, as the specification asks for: one frame or several.
Result<Bytes> from_lz4(ByteSpan bytes, std::size_t size) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0) {
    return fail(ErrorCode::kInternal, "lz4: no memory");
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(made,
                                                                                     LZ4F_freeDecompressionContext);
  Bytes out(size);
  std::size_t written = 0;
  std::size_t taken = 0;
  while (taken < bytes.size()) {
    std::size_t room = out.size() - written;
    std::size_t left = bytes.size() - taken;
    const std::size_t more =
        LZ4F_decompress(context.get(), out.data() + written, &room, bytes.data() + taken, &left, nullptr);
    if (LZ4F_isError(more) != 0) return damaged(kLz4, LZ4F_getErrorName(more));
    if (room == 0 && left == 0) return damaged(kLz4, "chunk is longer than its header says");
    written += room;
    taken += left;
  }
  if (written != size) return damaged(kLz4, "chunk is shorter than its header says");
  return out;
}

}  // namespace

Result<Bytes> compress(ByteSpan bytes) {
  Bytes out(ZSTD_compressBound(bytes.size()));
  const std::size_t n = ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), kLevel);
  if (ZSTD_isError(n) != 0) return fail(ErrorCode::kInternal, std::string("zstd: ") + ZSTD_getErrorName(n));
  out.resize(n);
  return out;
}

Result<Bytes> decompress(std::string_view compression, ByteSpan bytes, std::size_t size) {
  if (compression.empty()) {
    if (bytes.size() != size) return fail(ErrorCode::kCaptureCorrupt, "head is damaged");
    return Bytes(bytes.begin(), bytes.end());
  }
  if (compression == kZstd) return from_zstd(bytes, size);
  if (compression == kLz4) return from_lz4(bytes, size);
  return fail(ErrorCode::kCaptureInvalid, "compression '" + std::string(compression) + "' is not read here");
}

}  // namespace enamel::mcap
