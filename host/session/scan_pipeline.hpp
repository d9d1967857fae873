// The stage graph of a scan, from bursts to the model: source -> decode -> track -> fuse -> sink. The model, and what
// decoding shows of the projector, are fed back through delay edges; a preview tap keeps the latest. Live scans and
// replays run exactly this. A rig with temperature terms is taken at the temperature of the first burst.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/defects/survey.hpp"
#include "host/ingest/ingress_gate.hpp"
#include "host/report/report.hpp"
#include "host/report/stage_trace.hpp"
#include "host/session/pipeline_config.hpp"
#include "host/session/scratch_space.hpp"
#include "host/session/segment_ledger.hpp"
#include "pipeline/flow/step_observer.hpp"
#include "pipeline/register/map/refine_map.hpp"
#include "pipeline/tissue/shade_limit.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/mesh.hpp"
#include "pipeline/types/preview.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/latest_slot.hpp"
#include "protocol/base/result.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::host {

/// A burst on its way into the graph.
struct Accepted {
  BurstId id;
  std::shared_ptr<const proto::Burst> burst;
  std::optional<HostTime> exposed = {};  ///< end of the last exposure on the host's clock; live only
  std::optional<HostTime> arrived = {};  ///< when the link handed it over; live only
};

struct PlacedPose {
  BurstId id;
  DeviceTime t_mid;
  Pose T_model_cam;  ///< at t_mid
};

/// A segment whose place in the model nobody knows: kept beside it, in a frame of its own.
struct ApartSegment {
  SegmentId id = 0;
  std::vector<PlacedPose> poses;
  Mesh mesh;
};

/// What the refinement after the scan did.
struct MapFacts {
  pipeline::RefinedMap map;           ///< without its poses
  std::uint64_t seen_through_px = 0;  ///< left out of the final model: other bursts looked through there …
  std::uint64_t measured_px = 0;      ///< … of so many
  double refine_s = 0, seconds = 0;   ///< for the poses alone; with the model fused anew
};

/// What a run leaves behind. Everything but times is a function of the bursts, the rig and the configuration.
struct ScanResult {
  StageTrace trace;
  std::vector<PlacedPose> poses;  ///< of the bursts fused into the model, in order
  Mesh mesh;
  std::vector<ApartSegment> apart;       ///< ascending id
  std::vector<SegmentRow> segments;      ///< as they were scanned, ascending id
  std::optional<MapFacts> map;           ///< where the poses were refined
  pipeline::ShadeHeaps shades;           ///< teeth and soft tissue by their brightness
  std::optional<SurveyResult> survey;    ///< of the mesh by its bursts; where these were kept
  std::vector<BurstId> undetermined;     ///< fused, but where they lie neither shape nor texture told
  std::vector<BurstId> repeated;         ///< byte for byte a burst a moment before
  std::vector<BurstId> clock_went_back;  ///< no younger than the burst before, by the probe's clock
  std::uint64_t accepted = 0, fused = 0;
  std::map<std::string, std::uint64_t> rejected;
  OrderTotals orders;
  SightTotals sight;
  std::map<std::string, Percentiles> stage_ms;
  Percentiles latency_ms;
  Percentiles pixel_ms;         ///< last exposure to the screen, of the bursts that were shown; live only
  std::vector<double> link_ms;  ///< last exposure to host, of each accepted burst; live only
  double seconds = 0;           ///< from the first burst in to the last burst out
  std::optional<std::array<double, 2>> temp_c;  ///< coldest and warmest burst, degrees C; empty without bursts
  PipelineFigures figures;                      ///< of the whole run, wall time …
  std::string graph_json;                       ///< … and everything that the graph knows of it
  std::string desktop_json;                     ///< of a scan by stops: how they were laid; else empty
  std::string desktop_line;                     ///< the same for people
  std::vector<std::string> slips;               ///< of its table or model, a line each
};

/// Workers for a machine of so many cores (0: unknown): as many as the graph has steps at once, at least two.
[[nodiscard]] int usual_workers(unsigned cores);

struct ScanPipelineOptions {
  int workers = 2;                ///< 0: one thread, topological order
  bool preview_model = false;     ///< mesh the growing model for a window
  bool follow_map = false;        ///< the map works while bursts come, when no stage wants the processor
  std::uint32_t calib_crc32 = 0;  ///< bursts that name another calibration are rejected; 0: any
  std::size_t waiting_room = 2;   ///< bursts that push() takes before it waits
  /// Sees every preview that the slot gets, on a thread of the graph; may be empty.
  std::function<void(const BurstPreview&)> on_preview{};
  /// Of the nameless file that kept bursts go to once 128 MB of them are in memory; on a disk.
  std::string scratch_folder = default_scratch_folder();
  /// Watches the graph's steps; must outlive the pipeline. Null: nobody.
  flow::StepObserver* step_observer = nullptr;
};

using PreviewSlot = LatestSlot<std::shared_ptr<const BurstPreview>>;

/// push() from one thread, preview().take() from one thread, the rest from the owner.
class ScanPipeline {
 public:
  /// Errors: kRigInvalid, kPatternSet, kPatternAmbiguous.
  [[nodiscard]] static Result<std::unique_ptr<ScanPipeline>> create(const calib::Rig& rig, const PipelineConfig& config,
                                                                    const ScanPipelineOptions& options, Clock& clock);
  ~ScanPipeline();

  /// Waits for room; false after finish() or a fatal stage.
  bool push(Accepted item);
  /// Bursts that push() took and no decoder has taken yet. From any thread.
  [[nodiscard]] std::size_t waiting() const;
  /// No more bursts: what is inside is worked off.
  void finish();
  /// Waits until the graph has worked everything off and the map is refined, or a stage failed.
  void wait_drained();
  /// Ends the workers. Errors: kInternal with the stage that failed.
  [[nodiscard]] Result<void> join();

  [[nodiscard]] PreviewSlot& preview();
  /// The picture that first shows this burst is on the screen since `at`. From the thread that draws.
  void shown(BurstId burst, HostTime at);
  /// Bursts that have reached the sink so far, and how soon; after the last one, how far the refinement is. From any
  /// thread.
  void count_into(PreviewFrame& frame) const;
  /// From any thread; null before the first burst.
  [[nodiscard]] std::shared_ptr<const PipelineFigures> figures() const;
  /// After join(): extracts the mesh and hands everything over.
  [[nodiscard]] ScanResult take_result();

 private:
  struct Impl;
  explicit ScanPipeline(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::host
