// report.json: what a run says of itself. Keys as in docs/recording-format.md, the same for demo, scan and replay.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/report/accounting.hpp"
#include "host/report/sight_report.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

struct Percentiles {
  double p50 = 0, p95 = 0, p99 = 0;
};

[[nodiscard]] Percentiles percentiles_of(std::vector<double> values);

/// The code's fringe orders beside what the model shows, summed over the placed bursts.
struct OrderTotals {
  std::uint64_t checked_px = 0, contradicting_px = 0;
  std::uint64_t suspect_bursts = 0;  ///< in which the contradiction puts code or placement in doubt
  std::uint64_t guided_px = 0;       ///< left open by the code, decided by the model
  std::uint64_t withdrawn_px = 0;    ///< left out because code and model contradict each other
};

/// A stretch of bursts that began anew because nothing told where it lies: joined to an older one, or still apart.
struct SegmentFacts {
  std::uint64_t id = 0;
  std::uint64_t bursts = 0;  ///< placed in it while it stood for itself
  std::uint64_t first_burst = 0, last_burst = 0;
  std::optional<std::uint64_t> into;       ///< the segment that it was joined to; 0: the model. None: it is apart
  std::optional<std::uint64_t> joined_at;  ///< the burst that proved it; none: found after the last burst
  std::string folder;                      ///< relative to the report, where it is apart
};

struct Report {
  BurstCounts bursts;
  std::vector<SegmentFacts> segments;       ///< besides the model
  std::vector<std::uint64_t> undetermined;  ///< bursts, ascending: neither shape nor texture told where they lie
  std::string known_line;                   ///< for people: how surely distances are known, or empty
  OrderTotals orders;
  SightTotals sight;
  double rate_hz = 0;           ///< accepted bursts by the time the run took; wall time, so not part of the hash
  Percentiles latency_ms;       ///< last exposure to fused, live runs only
  Percentiles pixel_ms;         ///< last exposure to the screen, of the bursts shown; live runs with a window only
  std::vector<double> link_ms;  ///< last exposure to host, of each accepted burst in order; live runs only
  std::map<std::string, Percentiles> stage_ms;
  std::string pipeline_json;  ///< object: what each stage took and waited for; wall time, so not part of the hash
  std::string bottleneck;     ///< one line of it: what set the rate
  std::string hash;           ///< SHA-256 over every stage's output of every burst, in order, and the mesh
  std::uint64_t mesh_vertices = 0;
  std::uint64_t mesh_triangles = 0;
  std::string accuracy_json;     ///< object with the keys of `enamel compare --json`, empty when the truth is not known
  std::string map_json;          ///< object: what the refinement after the scan did, empty when there was none
  std::string tissue_json;       ///< object: what was taken for passing bodies; empty without refinement
  std::string defects_json;      ///< list: what is wrong with the finished surface; empty: not inspected
  std::string defects_line;      ///< for people: how many of which class, or empty
  std::string desktop_json;      ///< object: how the stops of a desktop scan were laid; empty of any other
  std::string calibration_json;  ///< object: which calibration measured, by its sha256, and what is expected of it
  std::map<std::string, std::string> notes;  ///< facts for people: what drew the picture, which pace, seed
  std::string config_toml;                   ///< resolved configuration
  bool simulated = false;
};

/// "2 joined to the model, 1 apart (14 bursts): segments/03", or empty where there is nothing but the model.
[[nodiscard]] std::string segments_line(const std::vector<SegmentFacts>& segments);

/// "120 bursts (12-98, 130-162): …", or empty.
[[nodiscard]] std::string undetermined_line(const std::vector<std::uint64_t>& bursts);

[[nodiscard]] std::string to_json(const Report& report);

/// Errors: kFileWrite. The file appears whole or not at all.
[[nodiscard]] Result<void> write_report(const Report& report, const std::string& path);

}  // namespace enamel::host
