// Tests with large draws have a short form for every build and the full one of `tools/test --full`.
#pragma once

#include <cstdlib>

namespace enamel::test {

inline bool is_full_form() { return std::getenv("ENAMEL_FULL_TESTS") != nullptr; }

}  // namespace enamel::test
