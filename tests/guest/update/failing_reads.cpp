// Preloaded into enamel-updated: every tenth data stage fails as it does in the moment in which a cable goes, before
// the kernel has begun it (usb_ep_queue: ESHUTDOWN). Its setup packet stays pending.
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "tests/guest/update/endpoint0.hpp"

extern "C" ssize_t read(int fd, void* bytes, std::size_t size) {
  using Read = ssize_t (*)(int, void*, std::size_t);
  static const auto real = reinterpret_cast<Read>(dlsym(RTLD_NEXT, "read"));
  constexpr std::size_t kBlock = 4096;  // no event is as long
  static int stages = 0;
  if (size != kBlock || !is_endpoint0(fd)) return real(fd, bytes, size);
  ++stages;
  if (stages != 400 && stages != 1000) return real(fd, bytes, size);
  errno = ESHUTDOWN;
  return -1;
}
