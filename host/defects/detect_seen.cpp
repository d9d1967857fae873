#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/defects/detect.hpp"
#include "host/defects/place_grid.hpp"

namespace enamel::host::defects {
namespace {

/// What bursts saw somewhere, gathered by place.
struct Sighting {
  Vec3d p_model = Vec3d::Zero();
  double mm2 = 0;
};
struct Place {
  Vec3d middle = Vec3d::Zero();
  std::vector<Sighting> sightings;
  [[nodiscard]] double largest_mm2() const {
    double out = 0;
    for (const Sighting& s : sightings) out = std::max(out, s.mm2);
    return out;
  }
};

/// In order: each joins the first place whose first sighting is near, or begins one. Most sightings first.
std::vector<Place> gather(const std::vector<Sighting>& all, double near_mm) {
  std::vector<Place> out;
  for (const Sighting& s : all) {
    const auto found =
        std::ranges::find_if(out, [&](const Place& p) { return (p.middle - s.p_model).norm() < near_mm; });
    if (found == out.end()) {
      out.push_back({s.p_model, {s}});
    } else {
      found->sightings.push_back(s);
    }
  }
  std::ranges::stable_sort(out, std::ranges::greater{}, [](const Place& p) { return p.sightings.size(); });
  return out;
}

/// Largest clusters of points that one burst lost, each as one sighting at its middle.
std::vector<Sighting> lost_at_once(const SurveyResult& survey, double near_mm) {
  std::vector<Sighting> out;
  for (std::size_t begin = 0; begin < survey.passed.size();) {
    std::size_t end = begin;
    std::vector<Sighting> points;
    while (end < survey.passed.size() && survey.passed[end].burst == survey.passed[begin].burst) {
      points.push_back({survey.passed[end].p_model.cast<double>(), survey.passed_mm2});
      ++end;
    }
    for (const Place& p : gather(points, near_mm)) {
      Vec3d sum = Vec3d::Zero();
      for (const Sighting& s : p.sightings) sum += s.p_model;
      const auto n = static_cast<double>(p.sightings.size());
      out.push_back({sum / n, n * survey.passed_mm2});
    }
    begin = end;
  }
  return out;
}

Defect of_region(const Seen& seen, DefectClass kind, const Region& region) {
  Defect out;
  out.kind = kind;
  out.p_model_mm = place_of(seen.surface, region.middle);
  out.size_mm2 = region.area_mm2;
  return out;
}

}  // namespace

void find_stitching(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out) {
  const SurfaceCells& cells = seen.surface.cells;
  std::vector<bool> over(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    const CellFacts& f = seen.survey.facts[c];
    const auto drift = static_cast<double>(std::abs(f.drift_mm));
    over[c] =
        kDefectUmPerMm * drift > config.drift_um && drift > config.drift_sigmas * static_cast<double>(f.drift_sigma_mm);
  }
  over = majority(cells, over);
  for (const Region& r : regions(seen.surface.mesh, cells, [&](std::uint32_t c) { return over[c]; })) {
    if (r.area_mm2 < config.drift_mm2) break;
    double sum = 0;
    for (const std::uint32_t c : r.cells) sum += static_cast<double>(std::abs(seen.survey.facts[c].drift_mm));
    Defect d = of_region(seen, DefectClass::kStitching, r);
    d.value = kDefectUmPerMm * sum / static_cast<double>(r.cells.size());
    d.limit = config.drift_um;
    d.confidence = confidence_of(d.value / d.limit);
    d.words = fmt::format(
        "passes lie {:.0f} um apart here: something gave way or was joined wrongly. Cut it out and scan here again in "
        "one go, from sound teeth on both sides",
        d.value);
    out.push_back(std::move(d));
  }
}

void find_unreliable(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out) {
  const SurfaceCells& cells = seen.surface.cells;
  const auto is_few = [&](std::uint32_t c) {
    return seen.survey.facts[c].views <= static_cast<std::uint32_t>(config.few_views);
  };
  std::size_t all_few = 0;
  for (std::uint32_t c = 0; c < cells.size(); ++c) all_few += is_few(c) ? 1U : 0U;
  const bool most = static_cast<double>(all_few) > config.few_views_share * static_cast<double>(cells.size());
  std::vector<bool> few(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    few[c] = is_few(c) && (most || seen.surface.from_rim_mm[c] >= config.from_rim_mm);
  few = majority(cells, few);
  for (const Region& r : regions(seen.surface.mesh, cells, [&](std::uint32_t c) { return few[c]; })) {
    if (r.area_mm2 < config.few_views_mm2) break;
    double views = 0;
    for (const std::uint32_t c : r.cells) views += seen.survey.facts[c].views;
    Defect d = of_region(seen, DefectClass::kReliability, r);
    d.value = views / static_cast<double>(r.cells.size());
    d.limit = config.few_views;
    d.confidence = confidence_of(r.area_mm2 / config.few_views_mm2);
    d.words = fmt::format("seen by {:.1f} bursts only: go over it again, slowly", d.value);
    out.push_back(std::move(d));
  }
}

void find_tissue(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out) {
  std::vector<Sighting> large;
  for (const Sighting& s : lost_at_once(seen.survey, config.place_mm))
    if (s.mm2 >= config.passed_mm2) large.push_back(s);
  for (const Place& p : gather(large, config.place_mm)) {
    const auto bursts = static_cast<int>(p.sightings.size());
    if (bursts < config.passed_bursts) break;
    const double ratio = static_cast<double>(bursts) / config.passed_bursts;
    out.push_back({DefectClass::kTissue, p.middle, p.largest_mm2(), static_cast<double>(bursts),
                   static_cast<double>(config.passed_bursts), confidence_of(ratio),
                   fmt::format("something passed before the surface in {} bursts and was left out: hold tongue, cheek "
                               "and glove away, look here whether surface is missing",
                               bursts)});
  }
}

void find_humidity(const Seen& seen, const InspectConfig& config, std::vector<Defect>& out) {
  std::vector<Sighting> all;
  for (const std::uint32_t cell : seen.survey.glare_cells)
    all.push_back({place_of(seen.surface, cell), seen.surface.cells.area_mm2[cell]});
  for (const Place& p : gather(all, config.place_mm)) {
    const auto bursts = static_cast<int>(p.sightings.size());
    if (bursts < config.glare_bursts) break;
    double mm2 = 0;
    for (const Sighting& s : p.sightings) mm2 += s.mm2;
    const double ratio = static_cast<double>(bursts) / config.glare_bursts;
    out.push_back({DefectClass::kHumidity, p.middle, mm2, static_cast<double>(bursts),
                   static_cast<double>(config.glare_bursts), confidence_of(ratio),
                   fmt::format("mirror light in {} bursts: dry here and scan it again", bursts)});
  }
}

}  // namespace enamel::host::defects
