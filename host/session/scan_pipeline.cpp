#include "host/session/scan_pipeline.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "host/session/end_joins.hpp"
#include "host/session/end_stages.hpp"
#include "host/session/end_survey.hpp"
#include "host/session/final_map.hpp"
#include "host/session/live_map.hpp"
#include "host/session/pipeline_figures.hpp"
#include "host/session/temp_range.hpp"
#include "host/session/wave_before.hpp"
#include "pipeline/flow/executor.hpp"
#include "pipeline/flow/graph.hpp"
#include "pipeline/stages/decode_stage.hpp"
#include "pipeline/stages/fuse_stage.hpp"
#include "pipeline/stages/learn_stage.hpp"
#include "pipeline/stages/track_stage.hpp"

namespace enamel::host {

namespace {

// Two decoders keep two cores busy while registration waits for its turn; the order is restored behind them. Four,
// where there are workers for them, are as fast as fusion; on two cores they would only keep more bursts waiting.
constexpr std::size_t kDecoders = 2, kMostDecoders = 4;
static_assert(kWaveDelay % kDecoders == 0 && kWaveDelay % kMostDecoders == 0);
constexpr unsigned kStepsAtOnce = kMostDecoders + 2;  // registration and fusion beside them

constexpr std::size_t decoders_for(int workers) {
  return workers < static_cast<int>(kMostDecoders) ? kDecoders : kMostDecoders;
}

}  // namespace

int usual_workers(unsigned cores) { return static_cast<int>(std::clamp(cores, 2U, kStepsAtOnce)); }

struct ScanPipeline::Impl {
  Impl(const calib::Rig& r, const PipelineConfig& p, const ScanPipelineOptions& o, Clock& c)
      : rig(r), config(p), options(o), clock(c), gate(o.waiting_room, GatePolicy::kLossless), graph(c) {}

  void start(std::optional<double> temp_c);
  void open(std::optional<double> temp_c);
  void build();
  void run(const std::stop_token& stop);
  void conclude(pipeline::EdgeMemo* memo);

  calib::Rig rig, optics;  ///< as told, and at the first burst's temperature
  PipelineConfig config;
  std::shared_ptr<const pipeline::BurstDecoder> decoder;  ///< of `rig` as it stands
  ScanPipelineOptions options;
  Clock& clock;
  std::once_flag started;
  IngressGate<Accepted> gate;
  ExposureTimes exposures, to_show;  ///< live only; to_show with somebody who watches
  LogHistogram pixel_ns;             ///< last exposure to the screen
  std::vector<double> link_ms;       ///< of push()'s thread
  flow::Graph graph;
  PreviewSlot preview;
  std::atomic<SinkStage*> sink{nullptr};  ///< of the graph, once built
  SourceStage* source = nullptr;
  stage::TrackStage* track = nullptr;
  stage::FuseStage* fuse = nullptr;
  std::unique_ptr<LiveMap> live_map;  ///< asks `fuse` for patches
  std::atomic<std::uint64_t> pushed{0};
  std::optional<HostTime> first_push;
  std::optional<std::array<double, 2>> temp_c;  ///< coldest and warmest burst
  HostTime drained_at{};
  std::vector<MeasuredBurst> placed;  ///< the model's bursts, once concluded …
  std::optional<MapFacts> map;        ///< … and refined
  Refined kept;                       ///< what the survey of the finished surface takes
  std::atomic<double> refined{-1};    ///< share done; negative: not begun
  Result<void> ran;
  std::atomic<bool> drained{false};
  std::jthread thread;  // last: ends before what it uses
};

/// The graph is made on its own thread: who pushes the first burst, a recorder, has the next one to write.
void ScanPipeline::Impl::start(std::optional<double> temp_c_first) {
  std::call_once(started, [&] {
    thread = std::jthread([this, temp_c_first](const std::stop_token& stop) {
      open(temp_c_first);
      run(stop);
    });
  });
}

/// Optics at the first burst's temperature: a scan takes minutes, the optics drift over the better part of an hour.
/// What the bursts' temperatures were stands in the result.
void ScanPipeline::Impl::open(std::optional<double> temp_c_first) {
  optics = rig;
  if (rig.temperature && temp_c_first) {
    optics = calib::rig_at(rig, *temp_c_first);
    if (auto warm = pipeline::BurstDecoder::make(optics, config.decode)) {
      decoder = std::make_shared<const pipeline::BurstDecoder>(std::move(*warm));
    } else {
      ran = tl::unexpected<Error>(warm.error());
    }
  }
  build();
  if (ran) ran = graph.validate();
}

void ScanPipeline::Impl::build() {
  graph.observe(options.step_observer);
  auto& entrance = graph.add<SourceStage>(gate);
  source = &entrance;
  std::vector<flow::In<proto::Burst>*> ins;
  std::vector<flow::In<pipeline::WaveKnowledge>*> waves;
  std::vector<flow::Out<stage::Decoded>*> outs;
  for (std::size_t i = 0; i < decoders_for(options.workers); ++i) {
    auto& decode = graph.add<stage::DecodeStage>("decode" + std::to_string(i), decoder, options.calib_crc32);
    ins.push_back(&decode.burst), waves.push_back(&decode.wave), outs.push_back(&decode.patch);
  }
  auto& learner = graph.add<stage::LearnStage>();
  track = &graph.add<stage::TrackStage>(optics, config.track, config.guide, decoder);
  const stage::FuseStageConfig fuse_config{.fuse = config.fuse,
                                           .mesh = config.mesh,
                                           .preview_model = options.preview_model,
                                           .preview_period = config.preview_period,
                                           .keep_history = config.map.refine,
                                           .store = kept_in(options.scratch_folder)};
  fuse = &graph.add<stage::FuseStage>(optics, fuse_config,
                                      pipeline::Unpacker(decoder->shared_rays(), decoder->config().normals));
  SinkStage& last = graph.add<SinkStage>(clock, exposures);
  if (options.follow_map && config.map.refine) {
    live_map =
        std::make_unique<LiveMap>(optics, config, [model = &fuse->segments()](const pipeline::StoredPatch& stored) {
          return model->patch_of(stored, pipeline::Texture::kDropped);
        });
    last.live_map = live_map.get();
  }
  auto& screen = graph.add<PreviewStage>(preview, live_map.get(), options.on_preview);

  const flow::EdgeSpec one{.capacity = 1};
  graph.connect_split<proto::Burst>(entrance.burst, ins, one);
  graph.connect_merge<stage::Decoded>(outs, track->patch, one);
  graph.connect_merge<stage::Decoded>(outs, learner.decoded, one);
  graph.connect(track->tracked, fuse->tracked, one);
  graph.connect(fuse->fused, last.fused);
  graph.connect(fuse->preview, screen.item, {.on_full = flow::OnFull::kKeepLatest});
  const flow::ItemHead none;
  graph.connect_feedback_split<pipeline::WaveKnowledge>(
      learner.known, waves, kWaveDelay, flow::make_item<pipeline::WaveKnowledge>(none, pipeline::WaveKnowledge{}));
  graph.connect_feedback(fuse->view, track->model, static_cast<std::size_t>(config.feedback_delay),
                         flow::make_item<ModelView>(none, ModelView{}));
  sink = &last;
}

void ScanPipeline::Impl::run(const std::stop_token& stop) {
  if (!ran) {
    // Nothing runs: what comes is turned away, and join() tells why.
  } else if (options.workers <= 0) {
    ran = flow::InlineExecutor().run(graph, stop);
  } else {
    ran = flow::WorkerExecutor(static_cast<std::size_t>(options.workers)).run(graph, stop);
  }
  drained_at = clock.now();
  pipeline::EdgeMemo* const memo = live_map ? &live_map->finish() : nullptr;
  gate.close();  // a stage that failed: nobody takes any more
  if (ran) conclude(memo);
  drained.store(true, std::memory_order_release);
  drained.notify_all();
}

/// What the whole scan allows that no burst did: segments are sought once more, the map is refined.
void ScanPipeline::Impl::conclude(pipeline::EdgeMemo* memo) {
  refined.store(0);
  join_at_end(*track, *fuse, sink.load()->segments, config.track.join);
  track->forget();
  hand_back_free_pages();
  placed = bursts_in(kModelSegment, *sink.load());
  if (config.map.refine) {
    const auto threads = static_cast<std::size_t>(std::max(options.workers, 1));
    const auto progress = [this](double share) { refined.store(share); };
    kept = refine_model({optics, config, threads, progress, memo}, placed, *fuse, clock);
    map = std::move(kept.facts);
    live_map.reset();
    hand_back_free_pages();
  }
  if (options.preview_model) preview.put(fuse->final_preview());
}

Result<std::unique_ptr<ScanPipeline>> ScanPipeline::create(const calib::Rig& rig, const PipelineConfig& config,
                                                           const ScanPipelineOptions& options, Clock& clock) {
  ENAMEL_TRY_ASSIGN(auto decoder, pipeline::BurstDecoder::make(rig, config.decode));
  auto impl = std::make_unique<Impl>(rig, config, options, clock);
  impl->decoder = std::make_shared<const pipeline::BurstDecoder>(std::move(decoder));
  return std::unique_ptr<ScanPipeline>(new ScanPipeline(std::move(impl)));
}

ScanPipeline::ScanPipeline(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

ScanPipeline::~ScanPipeline() { finish(); }

bool ScanPipeline::push(Accepted item) {
  if (!impl_->first_push) impl_->first_push = impl_->clock.now();
  impl_->start(item.burst->temp_centi_c / 100.0);
  take_in(*item.burst, impl_->temp_c);
  if (item.exposed) impl_->exposures.note(item.id, *item.exposed);
  if (item.exposed && impl_->options.preview_model) impl_->to_show.note(item.id, *item.exposed);
  if (item.exposed && item.arrived)
    impl_->link_ms.push_back(1e-6 * static_cast<double>((*item.arrived - *item.exposed).count()));
  if (impl_->gate.push(std::move(item))) return false;
  impl_->pushed.fetch_add(1, std::memory_order_relaxed);
  impl_->graph.waker().notify();
  return true;
}

std::size_t ScanPipeline::waiting() const { return impl_->gate.size(); }

void ScanPipeline::finish() {
  impl_->start(std::nullopt);
  impl_->gate.close();
  impl_->graph.waker().notify();
}

void ScanPipeline::wait_drained() { impl_->drained.wait(false, std::memory_order_acquire); }

Result<void> ScanPipeline::join() {
  if (impl_->thread.joinable()) impl_->thread.join();
  return impl_->ran;
}

PreviewSlot& ScanPipeline::preview() { return impl_->preview; }

void ScanPipeline::shown(BurstId burst, HostTime at) {
  if (const auto exposed = impl_->to_show.take(burst)) impl_->pixel_ns.record((at - *exposed).count());
}

void ScanPipeline::count_into(PreviewFrame& frame) const {
  const SinkStage* sink = impl_->sink;
  if (sink == nullptr) return;
  frame.counters.fused = sink->fused_count.value();
  frame.counters.rejected = sink->rejected_count.value();
  const LogHistogram::Summary on_screen = impl_->pixel_ns.summary();
  const LogHistogram::Summary latency = on_screen.count > 0 ? on_screen : sink->latency_ns.summary();
  frame.latency_ms = 1e-6 * static_cast<double>(latency.p50);
  if (const double share = impl_->refined.load(); share >= 0) {
    frame.state = ScanState::kRefining;
    frame.refined = share;
  }
}

std::shared_ptr<const PipelineFigures> ScanPipeline::figures() const {
  if (impl_->sink.load() == nullptr) return nullptr;  // the graph is not built yet
  return std::make_shared<const PipelineFigures>(figures_of(impl_->graph.snapshot()));
}

ScanResult ScanPipeline::take_result() {
  SinkStage& sink = *impl_->sink.load();
  ScanResult result;
  result.trace = std::move(sink.trace);
  result.segments = sink.segments.rows();
  result.map = impl_->map;
  result.poses = at_mid_burst(impl_->placed);
  for (const auto& [id, bursts] : impl_->fuse->segments().kept())
    result.apart.push_back({id, at_mid_burst(bursts_in(id, sink)), impl_->fuse->extract_apart(id)});
  result.shades = impl_->track->shades();
  result.undetermined = std::move(sink.undetermined);
  result.repeated = std::move(impl_->source->repeated);
  result.clock_went_back = std::move(sink.clock_went_back);
  result.rejected = std::move(sink.rejected);
  result.orders = sink.orders;
  result.sight = sink.sight;
  result.accepted = impl_->pushed.load();
  result.fused = sink.fused_count.value();
  result.mesh = impl_->fuse->extract_mesh();
  result.survey = survey_model({impl_->optics, result.mesh, impl_->placed}, std::move(impl_->kept), *impl_->fuse);
  const auto ms = [](const LogHistogram::Summary& s) {
    return Percentiles{static_cast<double>(s.p50) * 1e-6, static_cast<double>(s.p95) * 1e-6,
                       static_cast<double>(s.p99) * 1e-6};
  };
  const flow::GraphSnapshot snapshot = impl_->graph.snapshot();
  for (const auto& stage : snapshot.stages) {
    if (stage.name != "source" && stage.name != "sink") result.stage_ms[stage.name] = ms(stage.service_ns);
  }
  result.latency_ms = ms(sink.latency_ns.summary());
  result.pixel_ms = ms(impl_->pixel_ns.summary());
  result.link_ms = std::move(impl_->link_ms);
  if (impl_->first_push) result.seconds = std::chrono::duration<double>(impl_->drained_at - *impl_->first_push).count();
  result.temp_c = impl_->temp_c;
  result.figures = figures_of(snapshot);
  result.graph_json = flow::to_json(snapshot);
  return result;
}

}  // namespace enamel::host
