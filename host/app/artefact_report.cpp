#include "host/app/artefact_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace enamel::app {

nlohmann::json artefact_json(const pipeline::ArtefactFacts& facts) {
  constexpr double kUmPerMm = 1e3;
  nlohmann::json distances = nlohmann::json::array();
  for (const auto& d : facts.distances) {
    distances.push_back({{"spheres", {d.certified.i, d.certified.j}},
                         {"certified_um", kUmPerMm * d.certified.mm},
                         {"sigma_um", kUmPerMm * d.certified.sigma_mm},
                         {"before_um", kUmPerMm * d.before_mm},
                         {"before_sigma_um", kUmPerMm * d.before_sigma_mm},
                         {"after_um", kUmPerMm * d.after_mm},
                         {"held", d.held}});
  }
  nlohmann::json out{{"used", facts.used},
                     {"sightings", facts.seen},
                     {"other_sightings", facts.other},
                     {"edge_variance", facts.edge_variance},
                     {"distances", distances}};
  if (!facts.used) out["why_not"] = facts.why;
  return out;
}

std::string artefact_line(const nlohmann::json& artefact) {
  if (!artefact.value("used", false)) return "! not used: " + artefact.value("why_not", "");
  double before = 0, after = 0;
  std::size_t loose = 0, seen = 0;
  const nlohmann::json distances = artefact.value("distances", nlohmann::json::array());
  for (const nlohmann::json& d : distances) {
    before = std::max(before, std::abs(d.value("before_um", 0.0) - d.value("certified_um", 0.0)));
    after = std::max(after, std::abs(d.value("after_um", 0.0) - d.value("certified_um", 0.0)));
    if (!d.value("held", true)) ++loose;
  }
  for (const nlohmann::json& count : artefact.value("sightings", nlohmann::json::array()))
    seen += count.get<int>() > 0 ? 1U : 0U;
  std::string out = fmt::format("{} spheres, {} distances off by {:.1f} um at most, after it {:.1f} um", seen,
                                distances.size(), before, after);
  if (loose > 0) out += fmt::format("; ! {} that the surface contradicts", loose);
  constexpr double kMuch = 100;  // variance: ten times farther off than the map foretold
  if (artefact.value("edge_variance", 1.0) > kMuch)
    out += "; ! more than the map foretold: look at the calibration (enamel calibrate check)";
  return out;
}

}  // namespace enamel::app
