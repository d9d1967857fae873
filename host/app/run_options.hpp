// Options that every command which runs the pipeline shares, and what comes out of such a run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <thread>
#include <vector>

#include "host/app/calibration.hpp"
#include "host/desktop/desktop_config.hpp"
#include "host/report/report.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/scan_pipeline.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct RunOptions {
  std::string out;
  std::string config_file;
  std::vector<std::string> settings;  ///< a.b=value
  std::string artefact_file;          ///< certificate of a known artefact in the field of view; empty: none
  int workers = host::usual_workers(std::thread::hardware_concurrency());
  bool headless = false;
  bool fast = false;  ///< no refinement after the scan
  bool json = false;
};

/// Adds --config, --set, --threads, --headless, --json.
void add_run_options(CLI::App& app, RunOptions& options);

struct LoadedConfig {
  host::PipelineConfig pipeline;
  host::DesktopConfig desktop;  ///< with a pipeline of its own: the one above
  CalibrationLimits calibration;
  std::string text;  ///< resolved, TOML
};
/// Errors: of ConfigReader.
[[nodiscard]] Result<LoadedConfig> load_config(const RunOptions& options);

/// Truth of a simulated recording, when it carries one.
struct Truth {
  std::string surface_ply, poses_csv;  ///< contents; empty when unknown
  [[nodiscard]] bool known() const { return !surface_ply.empty() && !poses_csv.empty(); }
};

/// Writes mesh.stl, mesh.ply, poses.csv, stages.csv and report.json into `folder`; fills the report from the result
/// and, with the truth, the accuracy. Nothing is written when the folder cannot be made. Errors: kFileWrite.
[[nodiscard]] Result<host::Report> write_outputs(const std::string& folder, const host::ScanResult& scan,
                                                 host::Report report, const Truth& truth);

/// How surely the map knows the longest of its station distances, one standard deviation, or how the stops of a desktop
/// scan agree; empty where nothing is known.
[[nodiscard]] std::string known_line(const host::ScanResult& scan);

/// The short table at the end of a run, or the report as JSON, on stdout.
void print_summary(const host::Report& report, bool json);

/// Set by SIGINT, SIGTERM or SIGHUP once install_stop_signals() was called.
void install_stop_signals();
[[nodiscard]] bool stop_requested();

}  // namespace enamel::app
