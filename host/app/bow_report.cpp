#include "host/app/bow_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace enamel::app {
namespace {

nlohmann::json by_term(const pipeline::BowVector& mm) {
  constexpr double kUmPerMm = 1e3;
  nlohmann::json out = nlohmann::json::object();
  for (int m = 0; m < pipeline::kBowTerms; ++m)
    out[pipeline::kBowNames[static_cast<std::size_t>(m)]] = kUmPerMm * mm[m];
  return out;
}

double term_of(const nlohmann::json& terms, const char* name) { return terms.is_object() ? terms.value(name, 0.0) : 0; }

}  // namespace

nlohmann::json bow_json(const pipeline::BowFacts& facts) {
  return {{"um_at_edge", by_term(facts.bow)},         {"sigma_um", by_term(facts.sigma)},
          {"taken_out_um", by_term(facts.taken_out)}, {"rolled_deg", facts.rolled_deg},
          {"determined", facts.determined},           {"applied", facts.applied}};
}

std::string bow_line(const nlohmann::json& bow) {
  const int determined = bow.value("determined", 0);
  if (determined == 0) return "";
  const bool applied = bow.value("applied", false);
  if (!applied)
    return fmt::format("none found, as far as views rolled by {:.0f} deg tell", bow.value("rolled_deg", 0.0));
  const nlohmann::json taken = bow.value("taken_out_um", nlohmann::json::object());
  return fmt::format(
      "! {:.1f} um across, {:.1f} um along and {:.1f} um in the corners of the field, taken out of all bursts; "
      "calibrate the "
      "rig (enamel calibrate)",
      term_of(taken, "x2"), term_of(taken, "y2"), term_of(taken, "xy"));
}

}  // namespace enamel::app
