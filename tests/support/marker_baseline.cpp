#include "tests/support/marker_baseline.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace enamel::test {
namespace {

constexpr double kHalfCue = (2 / 3.14159265358979 - 1) / 2;  ///< midway between a marker's B4 - B3 and none
constexpr double kLeastPixels = 64;

struct Cue {
  double difference = 0, modulation = 0, pixels = 0;
};

int fringe_of(const algo::PhaseMaps& phase, const algo::FloodMaps& flood, std::size_t i) {
  return flood.turn[i] - (phase.phase_rad[i] < 0 ? 1 : 0);
}

/// By component and relative fringe.
std::map<std::pair<std::int32_t, int>, Cue> modulation_cues(const algo::PhaseMaps& phase,
                                                            const algo::FloodMaps& flood) {
  std::map<std::pair<std::int32_t, int>, Cue> cues;
  for (std::size_t i = 0; i < phase.phase_rad.size(); ++i) {
    const double d = static_cast<double>(phase.code_dn[i]), s3 = static_cast<double>(phase.sine_dn[i]);
    if (flood.component[i] < 0 || std::isnan(d)) continue;
    const double c = static_cast<double>(phase.cosine_dn[i]);
    const double three = std::hypot(c, s3), four = std::hypot(c, 0.5 * (d + s3));
    Cue& cue = cues[{flood.component[i], fringe_of(phase, flood, i)}];
    cue.difference += four - three;
    cue.modulation += three;
    ++cue.pixels;
  }
  return cues;
}

}  // namespace

MarkerOrders orders_from_marker(const algo::PhaseMaps& phase, const algo::FloodMaps& flood, int marker_fringe) {
  struct Found {
    double cue = kHalfCue;
    int fringe = 0;
  };
  std::map<std::int32_t, Found> marker;  // of each component: the fringe that looks most like it
  for (const auto& [where, cue] : modulation_cues(phase, flood)) {
    const double mean = cue.difference / cue.modulation;
    if (cue.pixels < kLeastPixels || !(mean < kHalfCue)) continue;
    const auto known = marker.emplace(where.first, Found{}).first;
    if (mean < known->second.cue) known->second = {mean, where.second};
  }
  MarkerOrders out{Map<std::int32_t>(phase.phase_rad.width(), phase.phase_rad.height(), -1),
                   static_cast<int>(marker.size())};
  for (std::size_t i = 0; i < out.order.size(); ++i) {
    const auto found = marker.find(flood.component[i]);
    if (found == marker.end()) continue;
    out.order[i] = fringe_of(phase, flood, i) - found->second.fringe + marker_fringe;
  }
  return out;
}

}  // namespace enamel::test
