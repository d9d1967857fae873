#include "tests/bench/speed/malloc_count.hpp"

#include <cerrno>
#include <cstddef>

// glibc's own entry points, which stay reachable when a program defines malloc() itself.
extern "C" {
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* block, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;
}

namespace enamel::bench {
namespace {

constinit thread_local HeapUse used;

void note(std::size_t bytes) noexcept {
  ++used.blocks;
  used.bytes += bytes;
}

}  // namespace

HeapUse heap_use() noexcept { return used; }

}  // namespace enamel::bench

extern "C" {

void* malloc(std::size_t size) noexcept {
  enamel::bench::note(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  enamel::bench::note(count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) noexcept {
  enamel::bench::note(size);
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  enamel::bench::note(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  enamel::bench::note(size);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  enamel::bench::note(size);
  void* made = __libc_memalign(alignment, size);
  if (made == nullptr) return ENOMEM;
  *block = made;
  return 0;
}
}
