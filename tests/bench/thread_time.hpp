// What a bench measures.
#pragma once

#include <ctime>

namespace enamel::bench {

/// Processor time of this thread: other load on the machine does not count.
inline double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace enamel::bench
