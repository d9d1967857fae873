// Preloaded into enamel-updated: a daemon that answers wrongly, so that the guest's checks can be seen to fail. What it
// sends on endpoint 0 tells an error in GETSTATUS and another firmware in the status block.
#include <dlfcn.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "protocol/image/dfu.hpp"
#include "protocol/image/status_block.hpp"
#include "tests/guest/update/endpoint0.hpp"

using namespace enamel::image;

extern "C" ssize_t write(int fd, const void* bytes, std::size_t size) {
  using Write = ssize_t (*)(int, const void*, std::size_t);
  static const auto real = reinterpret_cast<Write>(dlsym(RTLD_NEXT, "write"));
  constexpr std::size_t kDfuStatus = 6, kState = 4, kSlotState = 7, kManifestSha = 39;
  if ((size != kDfuStatus && size != kStatusSize) || !is_endpoint0(fd)) return real(fd, bytes, size);
  std::array<std::byte, kStatusSize> wrong{};
  std::copy_n(static_cast<const std::byte*>(bytes), size, wrong.begin());
  if (size == kDfuStatus) {
    wrong[0] = static_cast<std::byte>(DfuStatus::kErrUnknown);
    wrong[kState] = static_cast<std::byte>(DfuState::kError);
  } else {
    wrong[kManifestSha] ^= std::byte{1};
    wrong[kSlotState] = std::byte{0};
  }
  return real(fd, wrong.data(), size);
}
