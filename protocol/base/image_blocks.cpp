#include "protocol/base/image_blocks.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <new>

namespace enamel {
namespace {

constexpr std::align_val_t kWholePage{4096};

struct Block {
  std::byte* data = nullptr;
  std::size_t bytes = 0;
};

/// Blocks in the order in which they came back. Never destroyed: images of static objects end after it would have.
struct Kept {
  std::mutex mutex;
  std::array<Block, 64> blocks{};  ///< chosen: by judgement; ten kinds of images, some of each
  std::size_t count = 0, bytes = 0;

  Block remove(std::size_t at) noexcept {
    const Block out = blocks[at];
    std::copy(blocks.begin() + static_cast<std::ptrdiff_t>(at) + 1, blocks.begin() + static_cast<std::ptrdiff_t>(count),
              blocks.begin() + static_cast<std::ptrdiff_t>(at));
    --count;
    bytes -= out.bytes;
    return out;
  }
};

constinit Kept kept;

}  // namespace

std::byte* take_image_block(std::size_t bytes) {
  if (kImageBlocksReused) {
    const std::scoped_lock lock(kept.mutex);
    for (std::size_t k = kept.count; k-- > 0;) {  // the last one may still be in a cache
      if (kept.blocks[k].bytes == bytes) return kept.remove(k).data;
    }
  }
  return static_cast<std::byte*>(::operator new(bytes, kWholePage));
}

void give_image_block(std::byte* block, std::size_t bytes) noexcept {
  if (!kImageBlocksReused || bytes > kImageBlocksKept_bytes) return ::operator delete(block, kWholePage);
  const std::scoped_lock lock(kept.mutex);
  while (kept.count == kept.blocks.size() || kept.bytes + bytes > kImageBlocksKept_bytes)
    ::operator delete(kept.remove(0).data, kWholePage);
  kept.blocks[kept.count++] = {block, bytes};
  kept.bytes += bytes;
}

}  // namespace enamel
