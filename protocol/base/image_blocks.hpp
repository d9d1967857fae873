// Memory of images that are made and dropped burst after burst. Given back to the system, each such block comes back as
// pages that the kernel clears and maps anew, one fault a page: a tenth of what decoding takes.
#pragma once

#include <cstddef>

namespace enamel {

// The address sanitizer is to see every block end: what is read after that is a defect it finds.
#if defined(__SANITIZE_ADDRESS__)
#define ENAMEL_IMAGE_BLOCKS_END 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define ENAMEL_IMAGE_BLOCKS_END 1
#endif
#endif
#ifdef ENAMEL_IMAGE_BLOCKS_END
inline constexpr bool kImageBlocksReused = false;
#else
inline constexpr bool kImageBlocksReused = true;
#endif

/// A block of at least `bytes` that begins with a page; what it holds is undefined. Throws std::bad_alloc. Thread-safe.
[[nodiscard]] std::byte* take_image_block(std::size_t bytes);

/// block: of take_image_block() with the same number of bytes. Kept for whoever asks for that many next, up to
/// kImageBlocksKept_bytes of all sizes together; beyond, the one kept longest is freed. Thread-safe.
void give_image_block(std::byte* block, std::size_t bytes) noexcept;

/// chosen: by judgement. The maps of five bursts of VGA.
inline constexpr std::size_t kImageBlocksKept_bytes = std::size_t{64} << 20U;

}  // namespace enamel
