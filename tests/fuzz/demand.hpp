// What a fuzz target demands of the code under test: a crash names what did not hold.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace enamel::test {

inline void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace enamel::test
