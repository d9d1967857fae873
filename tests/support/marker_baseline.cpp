#include "tests/support/marker_baseline.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "pipeline/decode/phase/phase.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "pipeline/decode/unwrap/flood.hpp"
#include "tests/support/four_step.hpp"

namespace enamel::test {
namespace {

constexpr double kHalfCue = (2 / 3.14159265358979 - 1) / 2;  ///< midway between a marker's B4 - B3 and none
constexpr double kLeastPixels = 64;
constexpr float kSlope_rad = 0.23F;  ///< phase change of one pixel on a slope of 75 degrees in the reference rig

struct Cue {
  double difference = 0, modulation = 0, pixels = 0;
};

int fringe_of(const pipeline::PhaseMaps& phase, const pipeline::FloodMaps& flood, std::size_t i) {
  return flood.wraps[i] - (phase.phase_rad[i] < 0 ? 1 : 0);
}

/// By component and relative fringe. four_dn: the four-frame modulation.
std::map<std::pair<std::int32_t, int>, Cue> modulation_cues(const pipeline::PhaseMaps& phase,
                                                            const pipeline::FloodMaps& flood,
                                                            const Map<float>& four_dn) {
  std::map<std::pair<std::int32_t, int>, Cue> cues;
  for (std::size_t i = 0; i < phase.phase_rad.size(); ++i) {
    if (flood.component[i] < 0 || std::isnan(phase.code_dn[i])) continue;
    const auto three = static_cast<double>(phase.modulation_dn[i]);
    Cue& cue = cues[{flood.component[i], fringe_of(phase, flood, i)}];
    cue.difference += static_cast<double>(four_dn[i]) - three;
    cue.modulation += three;
    ++cue.pixels;
  }
  return cues;
}

struct Found {
  double cue = kHalfCue;
  int fringe = 0;
};

/// Of each component: the fringe that looks most like the marker, where one does.
std::map<std::int32_t, Found> find_markers(const pipeline::PhaseMaps& phase, const pipeline::FloodMaps& flood,
                                           const Map<float>& four_dn) {
  std::map<std::int32_t, Found> markers;
  for (const auto& [where, cue] : modulation_cues(phase, flood, four_dn)) {
    const double mean = cue.difference / cue.modulation;
    if (cue.pixels < kLeastPixels || !(mean < kHalfCue)) continue;
    const auto known = markers.emplace(where.first, Found{}).first;
    if (mean < known->second.cue) known->second = {mean, where.second};
  }
  return markers;
}

}  // namespace

MarkerOrders orders_from_marker(const calib::Rig& rig, const pipeline::BurstView& view) {
  return orders_from_marker(rig, pipeline::RayDepth::bake(rig, *rig.depth_range).value(), view);
}

MarkerOrders orders_from_marker(const calib::Rig& rig, const pipeline::RayDepth& rays,
                                const pipeline::BurstView& view) {
  pipeline::PhaseMaps phase;
  pipeline::LinkMaps links;
  pipeline::FloodMaps flooded;
  pipeline::compute_phase(view, pipeline::noise_from_rig(*rig.noise, view.bit_depth), {}, phase);
  pipeline::reject_half_lit(phase.modulation_dn, phase.reject);
  pipeline::compute_links(phase, {rays.phase_mid_rad.data(), kSlope_rad, kSlope_rad}, {}, links);
  pipeline::reject_edges(links, phase);
  pipeline::flood(phase.phase_rad, links, flooded);
  Map<float> four_rad, four_dn;
  test::four_step(view, four_rad, four_dn);
  const auto markers = find_markers(phase, flooded, four_dn);
  MarkerOrders out{Map<std::int32_t>(view.width, view.height, -1), phase.phase_rad, static_cast<int>(markers.size())};
  for (std::size_t i = 0; i < out.order.size(); ++i) {
    const auto found = markers.find(flooded.component[i]);
    if (found == markers.end()) continue;
    out.order[i] = fringe_of(phase, flooded, i) - found->second.fringe + rig.patterns.marker_fringe;
  }
  return out;
}

}  // namespace enamel::test
