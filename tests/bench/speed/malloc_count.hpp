// Heap blocks that a thread has asked for: malloc and its kin, and with them operator new and every library. Linked
// into a program, malloc_count.cpp puts itself before the C library's allocator and hands everything on to it.
#pragma once

#include <cstdint>

namespace enamel::bench {

struct HeapUse {
  std::uint64_t blocks = 0;  ///< asked for; realloc() counts as one
  std::uint64_t bytes = 0;
};

/// Of the calling thread since it began.
[[nodiscard]] HeapUse heap_use() noexcept;

}  // namespace enamel::bench
