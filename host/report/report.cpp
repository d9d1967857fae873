#include "host/report/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::host {

namespace {

nlohmann::json percentiles(const Percentiles& p) { return {{"p50", p.p50}, {"p95", p.p95}, {"p99", p.p99}}; }

nlohmann::json link(const std::vector<double>& ms) {
  nlohmann::json out = percentiles(percentiles_of(ms));
  out["bursts"] = nlohmann::json::array();
  for (const double v : ms) out["bursts"].push_back(std::round(10 * v) / 10);
  return out;
}

nlohmann::json bursts(const BurstCounts& c, std::uint64_t undetermined) {
  return {{"captured", c.captured}, {"lost_on_wire", c.lost_on_wire}, {"incomplete", c.incomplete},
          {"shed", c.shed},         {"accepted", c.accepted},         {"fused", c.fused},
          {"rejected", c.rejected}, {"undetermined", undetermined},   {"determined", c.fused - undetermined}};
}

nlohmann::json orders(const OrderTotals& o) {
  return {{"checked_px", o.checked_px},
          {"contradicting_px", o.contradicting_px},
          {"suspect_bursts", o.suspect_bursts},
          {"guided_px", o.guided_px},
          {"withdrawn_px", o.withdrawn_px}};
}

nlohmann::json sight(const SightTotals& s) {
  const double share = s.translucent_bursts > 0 ? s.translucent_share / static_cast<double>(s.translucent_bursts) : 0;
  return {{"bursts", s.bursts},
          {"translucency",
           {{"bursts", s.translucent_bursts},
            {"share_of_surface", share},
            {"lifted_um", s.lifted_um()},
            {"left_sigma_um", s.left_sigma_um()}}}};
}

nlohmann::json segments(const std::vector<SegmentFacts>& all) {
  nlohmann::json out = nlohmann::json::array();
  for (const SegmentFacts& s : all) {
    nlohmann::json one{{"id", s.id},
                       {"bursts", s.bursts},
                       {"first_burst", s.first_burst},
                       {"last_burst", s.last_burst},
                       {"state", s.into ? "joined" : "apart"}};
    if (s.into) one["into"] = *s.into;
    if (s.into) one["joined_at"] = s.joined_at ? nlohmann::json(*s.joined_at) : nlohmann::json("end");
    if (!s.folder.empty()) one["folder"] = s.folder;
    out.push_back(std::move(one));
  }
  return out;
}

/// Ascending numbers as first and last of each run.
std::vector<std::array<std::uint64_t, 2>> runs_of(const std::vector<std::uint64_t>& numbers) {
  std::vector<std::array<std::uint64_t, 2>> out;
  for (const std::uint64_t n : numbers) {
    if (!out.empty() && out.back()[1] + 1 == n) {
      out.back()[1] = n;
    } else {
      out.push_back({n, n});
    }
  }
  return out;
}

}  // namespace

std::string undetermined_line(const std::vector<std::uint64_t>& bursts) {
  if (bursts.empty()) return "";
  const auto runs = runs_of(bursts);
  constexpr std::size_t kShown = 4;
  std::string where;
  for (std::size_t i = 0; i < std::min(runs.size(), kShown); ++i) {
    where += (i == 0 ? "" : ", ") + std::to_string(runs[i][0]);
    if (runs[i][1] != runs[i][0]) where += "-" + std::to_string(runs[i][1]);
  }
  if (runs.size() > kShown) where += ", ...";
  return std::to_string(bursts.size()) + " bursts (" + where + "): neither form nor texture told their motion";
}

std::string segments_line(const std::vector<SegmentFacts>& segments) {
  std::uint64_t joined = 0, apart = 0, bursts = 0;
  std::string folders;
  for (const SegmentFacts& s : segments) {
    if (s.into) {
      ++joined;
      continue;
    }
    ++apart;
    bursts += s.bursts;
    folders += (folders.empty() ? "" : ", ") + s.folder;
  }
  std::string out;
  if (joined > 0) out = std::to_string(joined) + " joined";
  if (apart == 0) return out;
  if (!out.empty()) out += ", ";
  return out + std::to_string(apart) + " apart (" + std::to_string(bursts) + " bursts): " + folders;
}

Percentiles percentiles_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.95), at(0.99)};
}

std::string to_json(const Report& r) {
  nlohmann::json stages = nlohmann::json::object();
  for (const auto& [name, p] : r.stage_ms) stages[name] = {{"p50", p.p50}, {"p99", p.p99}};
  nlohmann::json out = {{"bursts", bursts(r.bursts, r.undetermined.size())},
                        {"segments", segments(r.segments)},
                        {"undetermined", {{"bursts", r.undetermined.size()}, {"runs", runs_of(r.undetermined)}}},
                        {"orders", orders(r.orders)},
                        {"sight", sight(r.sight)},
                        {"rate_hz", r.rate_hz},
                        {"latency_ms", percentiles(r.latency_ms)},
                        {"pixel_ms", percentiles(r.pixel_ms)},
                        {"link_ms", link(r.link_ms)},
                        {"stage_ms", stages},
                        {"hash", r.hash},
                        {"mesh", {{"vertices", r.mesh_vertices}, {"triangles", r.mesh_triangles}}},
                        {"simulated", r.simulated},
                        {"notes", r.notes},
                        {"config", r.config_toml}};
  if (!r.accuracy_json.empty()) {
    out["accuracy"] = nlohmann::json::parse(r.accuracy_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.calibration_json.empty()) {
    out["calibration"] = nlohmann::json::parse(r.calibration_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.map_json.empty()) {
    out["map"] = nlohmann::json::parse(r.map_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.desktop_json.empty()) {
    out["desktop"] = nlohmann::json::parse(r.desktop_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.defects_json.empty()) {
    out["defects"] = nlohmann::json::parse(r.defects_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.tissue_json.empty()) {
    out["tissue"] = nlohmann::json::parse(r.tissue_json, nullptr, /*allow_exceptions=*/false);
  }
  if (!r.pipeline_json.empty()) {
    out["pipeline"] = nlohmann::json::parse(r.pipeline_json, nullptr, /*allow_exceptions=*/false);
  }
  return json_text(out, 1) + "\n";
}

Result<void> write_report(const Report& report, const std::string& path) { return write_file(path, to_json(report)); }

}  // namespace enamel::host
