// Parts of the decode study: each returns one section of its JSON. Deterministic but for times.
#pragma once

#include <ctime>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/types/map.hpp"

namespace enamel::bench {

using Json = nlohmann::ordered_json;

/// Processor time of this thread: other load on the machine does not count.
inline double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// A map for the page's pictures; a failed write ends the program with its message.
void save(const std::string& path, const Map<float>& map);

[[nodiscard]] Json noise_study();
[[nodiscard]] Json ripple_study();
[[nodiscard]] Json baked_study();
[[nodiscard]] Json unwrap_study(const std::string& folder);
[[nodiscard]] Json captured_study(const std::string& folder);
[[nodiscard]] Json modes_study();
/// bursts: of mode T; a tenth as many of mode M and of the marker.
[[nodiscard]] Json orders_study(int bursts);
/// Empty where the twin is not built.
[[nodiscard]] Json twin_study();

}  // namespace enamel::bench
