// What the libraries preloaded into enamel-updated share.
#pragma once

#include <unistd.h>

#include <array>
#include <string>
#include <string_view>

inline bool is_endpoint0(int fd) {
  std::array<char, 256> path{};
  const ssize_t n = readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), path.data(), path.size());
  return n > 0 && std::string_view(path.data(), static_cast<std::size_t>(n)).ends_with("/ep0");
}
