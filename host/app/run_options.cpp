#include "host/app/run_options.hpp"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/app/artefact_report.hpp"
#include "host/app/bow_report.hpp"
#include "host/session/artefact_file.hpp"
#include "protocol/base/config.hpp"

namespace enamel::app {

namespace {

std::atomic<bool> g_stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "written by a signal handler");

void on_signal(int) { g_stop.store(true); }

void row(const char* what, const std::string& value) { std::printf("  %-28s %s\n", what, value.c_str()); }

std::string number(double value, const char* format, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return std::string(text) + unit;
}

void print_calibration(const nlohmann::json& c) {
  if (!c.is_object()) return;
  std::string words = c.value("nominal", false) ? "design values" : c.value("verdict", "as it is");
  if (c.contains("expected_p95_um"))
    words += number(c["expected_p95_um"].get<double>(), ", expected within %.2f", " um");
  row("calibration", words + ", sha256 " + c.value("sha256", "").substr(0, 12));
  for (const auto& mark : c.value("marks", nlohmann::json::array())) row("", "! " + mark.get<std::string>());
}

void print_map(const nlohmann::json& m) {
  row("map", std::to_string(m.value("keyframes", 0)) + " keyframes, " + std::to_string(m.value("edges", 0)) +
                 " edges, moved by " + number(m.value("largest_move_um", 0.0), "%.0f", " um at most in ") +
                 number(m.value("seconds", 0.0), "%.1f", " s"));
  if (m.contains("artefact")) row("artefact", artefact_line(m["artefact"]));
  if (const std::string line = bow_line(m.value("bow", nlohmann::json::object())); !line.empty())
    row("rig's bow", line);
}

void print_accuracy(const nlohmann::json& a) {
  const auto get = [&](const char* key) { return a.contains(key) && a[key].is_number() ? a[key].get<double>() : 0.0; };
  row("mean absolute deviation", number(get("mean_abs_um"), "%.1f", " um"));
  row("95 % / 99 % within", number(get("p95_um"), "%.1f", " / ") + number(get("p99_um"), "%.1f", " um"));
  row("coverage of what was seen", number(get("coverage_pct"), "%.2f", " %"));
  if (a.contains("end_error_um") && a["end_error_um"].is_number()) {
    row("end of scan", number(get("end_error_um"), "%.1f", " um, ") + number(get("end_rotation_deg"), "%.3f", " deg"));
  }
}

}  // namespace

void install_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // The terminal was closed: the scan ends as with Ctrl-C. Under nohup it goes on.
  struct sigaction before {};
  if (sigaction(SIGHUP, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

bool stop_requested() { return g_stop.load(); }

void add_run_options(CLI::App& app, RunOptions& o) {
  app.add_option("--config", o.config_file, "configuration (TOML); see config/default.toml");
  app.add_option("--set", o.settings, "one setting over the configuration: stage.key=value")->allow_extra_args(false);
  app.add_option("--threads", o.workers, "workers of the stage graph; never changes the result")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  app.add_flag("--headless", o.headless, "no window");
  app.add_flag("--fast", o.fast, "the model as it grew: poses are not refined and nothing is fused anew at the end");
  app.add_option(
      "--artefact", o.artefact_file,
      "certificate (JSON) of a clip or bar with balls in the field of view: the map is tied to its distances");
  app.add_flag("--json", o.json, "the report on stdout instead of the table");
}

Result<LoadedConfig> load_config(const RunOptions& o) {
  auto reader = ConfigReader::empty();
  if (!o.config_file.empty()) {
    ENAMEL_TRY_ASSIGN(reader, ConfigReader::from_file(o.config_file));
  }
  for (const std::string& setting : o.settings) ENAMEL_TRY(reader.set(setting));
  if (o.fast) ENAMEL_TRY(reader.set("map.refine=false"));
  LoadedConfig config;
  host::bind(reader, config.pipeline);
  host::bind_desktop(reader, config.desktop);
  bind(reader, config.calibration);
  ENAMEL_TRY(reader.finish());
  config.text = reader.dump();
  if (o.artefact_file.empty()) return config;
  if (!config.pipeline.map.refine)
    return fail(ErrorCode::kUsage, "--artefact ties the refined map: leave out --fast and map.refine=false");
  ENAMEL_TRY_ASSIGN(config.pipeline.map.known, host::load_artefact(o.artefact_file));
  return config;
}

void print_summary(const host::Report& report, bool json) {
  if (json) {
    std::fputs(host::to_json(report).c_str(), stdout);
    return;
  }
  const host::BurstCounts& b = report.bursts;
  if (report.simulated) std::puts("SIMULATED");
  row("bursts",
      std::to_string(b.captured) + " captured, " + std::to_string(b.fused) + " fused" +
          (report.undetermined.empty() ? ""
                                       : " (" + std::to_string(report.undetermined.size()) + " of them undetermined)") +
          ", " + std::to_string(b.rejected_total()) + " rejected");
  row("losses", std::to_string(b.lost_on_wire) + " on the wire, " + std::to_string(b.incomplete) + " incomplete, " +
                    std::to_string(b.shed) + " shed");
  if (!report.map_json.empty()) print_map(nlohmann::json::parse(report.map_json, nullptr, /*allow_exceptions=*/false));
  if (!report.known_line.empty()) row(report.desktop_json.empty() ? "distances" : "stops", report.known_line);
  if (!report.undetermined.empty()) row("undetermined", host::undetermined_line(report.undetermined));
  if (!report.segments.empty()) row("segments", host::segments_line(report.segments));
  if (const std::string line = host::sight_line(report.sight); !line.empty()) row("sight", line);
  if (const std::string line = host::translucency_line(report.sight); !line.empty()) row("translucency", line);
  if (!report.defects_line.empty()) row("look again at", report.defects_line + ": enamel inspect FOLDER");
  const host::OrderTotals& o = report.orders;
  row("fringe orders", std::to_string(o.guided_px) + " px by the model, " + std::to_string(o.withdrawn_px) +
                           " px withdrawn, " + std::to_string(o.suspect_bursts) + " bursts in doubt");
  row("rate", number(report.rate_hz, "%.1f", " bursts/s"));
  if (report.latency_ms.p50 > 0) {
    row("latency p50 / p95 / p99", number(report.latency_ms.p50, "%.0f", " / ") +
                                       number(report.latency_ms.p95, "%.0f", " / ") +
                                       number(report.latency_ms.p99, "%.0f", " ms"));
  }
  if (report.pixel_ms.p50 > 0) {
    row("to the screen p50 / p95 / p99", number(report.pixel_ms.p50, "%.0f", " / ") +
                                             number(report.pixel_ms.p95, "%.0f", " / ") +
                                             number(report.pixel_ms.p99, "%.0f", " ms"));
  }
  if (!report.link_ms.empty()) {
    const host::Percentiles link = host::percentiles_of(report.link_ms);
    row("link p50 / p95 / p99",
        number(link.p50, "%.1f", " / ") + number(link.p95, "%.1f", " / ") + number(link.p99, "%.1f", " ms"));
  }
  for (const auto& [stage, p] : report.stage_ms) {
    row(("stage " + stage + " p50 / p99").c_str(), number(p.p50, "%.1f", " / ") + number(p.p99, "%.1f", " ms"));
  }
  if (!report.bottleneck.empty()) row("bottleneck", report.bottleneck);
  row("mesh",
      std::to_string(report.mesh_vertices) + " vertices, " + std::to_string(report.mesh_triangles) + " triangles");
  if (!report.calibration_json.empty()) {
    print_calibration(nlohmann::json::parse(report.calibration_json, nullptr, /*allow_exceptions=*/false));
  }
  if (!report.accuracy_json.empty()) {
    print_accuracy(nlohmann::json::parse(report.accuracy_json, nullptr, /*allow_exceptions=*/false));
  }
  row("hash", report.hash);
  for (const auto& [key, value] : report.notes) row(key.c_str(), value);
}

}  // namespace enamel::app
