#include "host/report/report.hpp"

#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"

namespace enamel::host {

namespace {

nlohmann::json percentiles(const Percentiles& p) { return {{"p50", p.p50}, {"p95", p.p95}, {"p99", p.p99}}; }

nlohmann::json bursts(const BurstCounts& c) {
  return {{"captured", c.captured}, {"lost_on_wire", c.lost_on_wire}, {"incomplete", c.incomplete},
          {"shed", c.shed},         {"accepted", c.accepted},         {"fused", c.fused},
          {"rejected", c.rejected}};
}

nlohmann::json orders(const OrderTotals& o) {
  return {{"checked_px", o.checked_px},
          {"contradicting_px", o.contradicting_px},
          {"suspect_bursts", o.suspect_bursts},
          {"guided_px", o.guided_px},
          {"withdrawn_px", o.withdrawn_px}};
}

}  // namespace

std::string to_json(const Report& r) {
  nlohmann::json stages = nlohmann::json::object();
  for (const auto& [name, p] : r.stage_ms) stages[name] = {{"p50", p.p50}, {"p99", p.p99}};
  nlohmann::json out = {{"bursts", bursts(r.bursts)},
                        {"orders", orders(r.orders)},
                        {"rate_hz", r.rate_hz},
                        {"latency_ms", percentiles(r.latency_ms)},
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
  if (!r.pipeline_json.empty()) {
    out["pipeline"] = nlohmann::json::parse(r.pipeline_json, nullptr, /*allow_exceptions=*/false);
  }
  return out.dump(1) + "\n";
}

Result<void> write_report(const Report& report, const std::string& path) { return write_file(path, to_json(report)); }

}  // namespace enamel::host
