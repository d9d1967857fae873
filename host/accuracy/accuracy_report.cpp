#include "host/accuracy/accuracy_report.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStyle = "in the style of ISO 12836 and ISO 5725-1; no test according to either";
constexpr const char* kNeedsTwo = "needs two runs";

struct Named {
  const char* key;
  const char* words;
  double DeviationFigures::*figure;
};
constexpr std::array<Named, 5> kFigures{{{"mean_abs_um", "mean |d|", &DeviationFigures::mean_abs_um},
                                         {"mean_um", "mean", &DeviationFigures::mean_um},
                                         {"rms_um", "rms", &DeviationFigures::rms_um},
                                         {"p95_um", "95 % of |d|", &DeviationFigures::p95_um},
                                         {"half_80_um", "(90 % - 10 %)/2", &DeviationFigures::half_80_um}}};

std::vector<double> values_of(const auto& items, double DeviationFigures::*figure) {
  std::vector<double> out;
  for (const auto& item : items) out.push_back(item.figures.*figure);
  return out;
}

std::vector<double> of_runs(const std::vector<ArtefactFigures>& runs, std::vector<double> ArtefactFigures::*kind,
                            std::size_t i) {
  std::vector<double> out;
  for (const ArtefactFigures& run : runs) out.push_back((run.*kind)[i]);
  return out;
}

Json spread_json(const std::vector<double>& values) {
  const Spread s = spread_of(values);
  return {{"mean", s.mean}, {"sd", s.sd ? Json(*s.sd) : Json()}, {"values", values}};
}

Json figures_json(const DeviationFigures& figures) {
  Json out{{"vertices", figures.count}};
  for (const Named& named : kFigures) out[named.key] = figures.*named.figure;
  return out;
}

Json over(const auto& items) {
  Json out;
  for (const Named& named : kFigures) out[named.key] = spread_json(values_of(items, named.figure));
  return out;
}

Json trueness_json(const AccuracyReport& report) {
  Json runs = Json::array();
  for (std::size_t i = 0; i < report.trueness.size(); ++i) {
    Json run{{"run", report.runs[i]}};
    run.update(figures_json(report.trueness[i].figures));
    run["beyond_border_pct"] = report.trueness[i].beyond_border_pct;
    runs.push_back(std::move(run));
  }
  return {{"reference", report.reference}, {"runs", runs}, {"over_runs", over(report.trueness)}};
}

Json precision_json(const AccuracyReport& report) {
  if (report.precision.empty()) return {{"why_not", kNeedsTwo}};
  Json pairs = Json::array();
  for (const PairDeviation& p : report.precision) {
    Json pair{{"runs", {report.runs[p.first], report.runs[p.second]}}};
    pair.update(figures_json(p.figures));
    pair["beyond_border_pct"] = p.beyond_border_pct;
    pairs.push_back(std::move(pair));
  }
  return {{"pairs", pairs}, {"over_pairs", over(report.precision)}};
}

Json artefact_json(const AccuracyReport& report) {
  Json balls = Json::array(), distances = Json::array();
  for (std::size_t i = 0; i < report.artefact.diameters_mm.size(); ++i) {
    std::vector<double> shares;
    for (const ArtefactFigures& run : report.artefact_runs) shares.push_back(100 * run.balls[i].share);
    balls.push_back({{"certified_mm", report.artefact.diameters_mm[i]},
                     {"form_um", spread_json(of_runs(report.artefact_runs, &ArtefactFigures::form_um, i))},
                     {"size_um", spread_json(of_runs(report.artefact_runs, &ArtefactFigures::size_um, i))},
                     {"seen_pct", spread_json(shares)}});
  }
  for (std::size_t k = 0; k < report.artefact.distances.size(); ++k) {
    const auto& d = report.artefact.distances[k];
    distances.push_back({{"spheres", {d.i, d.j}},
                         {"certified_mm", d.mm},
                         {"sigma_um", 1e3 * d.sigma_mm},
                         {"error_um", spread_json(of_runs(report.artefact_runs, &ArtefactFigures::distance_um, k))}});
  }
  return {{"balls", balls}, {"distances", distances}};
}

std::string line(const std::string& words, const std::vector<double>& values) {
  const Spread s = spread_of(values);
  std::string out = fmt::format("  {:<28} {:8.2f} um", words, s.mean);
  if (s.sd) out += fmt::format(" +- {:.2f}", *s.sd);
  return out + "\n";
}

std::string lines(const auto& items) {
  std::string out;
  for (const Named& named : kFigures) out += line(named.words, values_of(items, named.figure));
  return out;
}

std::string artefact_lines(const AccuracyReport& report) {
  std::string out = "artefact\n";
  for (std::size_t i = 0; i < report.artefact.diameters_mm.size(); ++i) {
    const std::string ball = fmt::format("ball {}, {:.3f} mm: ", i, report.artefact.diameters_mm[i]);
    out += line(ball + "form PF", of_runs(report.artefact_runs, &ArtefactFigures::form_um, i));
    out += line(ball + "size PS", of_runs(report.artefact_runs, &ArtefactFigures::size_um, i));
  }
  for (std::size_t k = 0; k < report.artefact.distances.size(); ++k) {
    const auto& d = report.artefact.distances[k];
    out += line(fmt::format("distance {}-{}, {:.3f} mm: SD", d.i, d.j, d.mm),
                of_runs(report.artefact_runs, &ArtefactFigures::distance_um, k));
  }
  return out;
}

}  // namespace

std::string accuracy_json(const AccuracyReport& report) {
  Json out{{"format", "enamel-accuracy"}, {"schema", 1}, {"style", kStyle}, {"simulated", report.simulated}};
  out["runs"] = report.runs;
  out["trueness"] = report.trueness.empty() ? Json() : trueness_json(report);
  out["precision"] = precision_json(report);
  out["artefact"] = report.artefact_runs.empty() ? Json() : artefact_json(report);
  return json_text(out, 1);
}

std::string accuracy_text(const AccuracyReport& report) {
  const std::size_t n = report.runs.size();
  std::string out =
      fmt::format("{} run{}{}, {}\n", n, n == 1 ? "" : "s", report.simulated ? ", SIMULATED" : "", kStyle);
  if (!report.trueness.empty())
    out += "trueness, from " + report.reference + " after best fit\n" + lines(report.trueness);
  if (report.precision.empty()) {
    out += std::string("precision: ") + kNeedsTwo + "\n";
  } else {
    out += fmt::format("precision, {} pair{} after best fit\n", report.precision.size(),
                       report.precision.size() == 1 ? "" : "s") +
           lines(report.precision);
  }
  if (!report.artefact_runs.empty()) out += artefact_lines(report);
  return out;
}

}  // namespace enamel::host
