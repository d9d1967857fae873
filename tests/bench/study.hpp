// Parts of the decode study: each returns one section of its JSON. Deterministic but for times.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/types/map.hpp"
#include "tests/bench/thread_time.hpp"

namespace enamel::bench {

using Json = nlohmann::ordered_json;

/// A map for the page's pictures; a failed write ends the program with its message.
void save(const std::string& path, const Map<float>& map);

[[nodiscard]] Json noise_study();
[[nodiscard]] Json ripple_study();
[[nodiscard]] Json baked_study();
[[nodiscard]] Json unwrap_study(const std::string& folder);
/// What the code makes of the flood's leaks: mode T through the whole decoder.
[[nodiscard]] Json unwrap_with_code(double noise_dn);
/// The same surface with one marker fringe, counted from there by the same links and flood.
[[nodiscard]] Json unwrap_with_marker(double noise_dn);
[[nodiscard]] Json captured_study(const std::string& folder);
[[nodiscard]] Json modes_study();
/// bursts: of mode T; a tenth as many of mode M and of the marker.
[[nodiscard]] Json orders_study(int bursts);
/// Empty where the twin is not built.
[[nodiscard]] Json twin_study();

}  // namespace enamel::bench
