// std::hardware_destructive_interference_size is missing in clang 14.
#pragma once

#include <cstddef>

namespace enamel {

inline constexpr std::size_t kCacheLine = 64;

}  // namespace enamel
