#include "firmware/acquire/acquisition.hpp"

#include <pthread.h>

#include <algorithm>
#include <utility>

#include "firmware/acquire/frame_digest.hpp"
#include "protocol/base/log.hpp"

namespace enamel::fw {
namespace {

using proto::DropReason;
using proto::ReplyStatus;

constexpr Nanoseconds kAbortTimeout{200'000'000};

AcquisitionReport failed(ReplyStatus fault) { return {AcquisitionPhase::kFailed, fault, false}; }
AcquisitionReport done() { return {AcquisitionPhase::kDone, ReplyStatus::kOk, false}; }

/// After these the projector may be out of step with the gate.
bool needs_restart(DropReason reason) {
  return reason == DropReason::kOrder || reason == DropReason::kMulti || reason == DropReason::kPartial ||
         reason == DropReason::kTimeout;
}

}  // namespace

Acquisition::Acquisition(const Hardware& hardware, LightSwitch& light, BurstLedger& ledger, BurstHandler handler,
                         const AcquisitionConfig& config)
    : hw_(hardware), light_(light), ledger_(ledger), handler_(std::move(handler)), config_(config) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  (void)pthread_setname_np(thread_.native_handle(), "fw-acquire");
}

Acquisition::~Acquisition() {
  thread_.request_stop();
  abort();
}

void Acquisition::begin(Job job, ScanTag session, std::optional<std::uint64_t> limit) {
  {
    const std::lock_guard lock(mutex_);
    request_ = Request{job, ++requests_, session, limit};
    report_ = {AcquisitionPhase::kRunning, ReplyStatus::kOk, false};
  }
  changed_.notify_all();
}

void Acquisition::scan(ScanTag session, std::optional<std::uint64_t> limit) { begin(Job::kScan, session, limit); }
void Acquisition::self_test() { begin(Job::kSelfTest); }
void Acquisition::calibrate() { begin(Job::kCalibrate); }

void Acquisition::drain() {
  const std::lock_guard lock(mutex_);
  drain_until_ = requests_;
}

void Acquisition::abort() {
  {
    const std::lock_guard lock(mutex_);
    abort_until_ = requests_;
  }
  hw_.camera.stop();  // ends a wait for the next frame
  std::unique_lock lock(mutex_);
  changed_.notify_all();
  changed_.wait_for(lock, kAbortTimeout, [&] { return report_.phase != AcquisitionPhase::kRunning; });
}

AcquisitionReport Acquisition::report() const {
  const std::lock_guard lock(mutex_);
  AcquisitionReport report = report_;
  report.beats = beats_.load(std::memory_order_acquire);
  return report;
}

std::optional<StampDelay> Acquisition::stamp_delay() const {
  const std::lock_guard lock(mutex_);
  return measured_delay_;
}

bool Acquisition::aborted() const {
  const std::lock_guard lock(mutex_);
  return current_ <= abort_until_;
}

bool Acquisition::drain_asked() const {
  const std::lock_guard lock(mutex_);
  return current_ <= drain_until_;
}

void Acquisition::run(const std::stop_token& stop) {
  for (;;) {
    Request request;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [&] { return request_.has_value(); })) return;
      request = *std::exchange(request_, std::nullopt);
      current_ = request.number;
    }
    const AcquisitionReport result = aborted() ? done() : do_job(request);
    light_.want(false);
    hw_.camera.stop();
    const std::lock_guard lock(mutex_);
    if (!request_) report_ = result;
    changed_.notify_all();
  }
}

AcquisitionReport Acquisition::do_job(const Request& request) {
  if (auto started = hw_.camera.start(); !started) {
    log::error("acquire", "{}", started.error().message());
    return failed(ReplyStatus::kNoCamera);
  }
  switch (request.job) {
    case Job::kScan:
      return run_scan(request);
    case Job::kSelfTest:
      return run_self_test();
    case Job::kCalibrate:
      return run_calibration();
    case Job::kNone:
      break;
  }
  return done();
}

Result<CameraFrame> Acquisition::next_frame() {
  auto frame = hw_.camera.next_frame();
  beats_.fetch_add(1, std::memory_order_acq_rel);
  return frame;
}

Result<CameraFrame> Acquisition::frame_with_edges(std::vector<Edge>& edges, DeviceTime& known_until) {
  auto frame = next_frame();
  edges.clear();
  known_until = hw_.edges.read(edges);
  return frame;
}

AcquisitionReport Acquisition::run_scan(const Request& request) {
  BurstAssembler assembler(AssemblerConfig::for_mode(hw_.camera.mode(), stamp_delay_, config_.max_delay_spread));
  sequencer_.start(request.limit);
  begun_seen_ = 0;
  restarts_seen_ = hw_.camera.restarts();
  if (auto restarted = hw_.projector.restart(); !restarted) return failed(ReplyStatus::kProjNotReady);
  light_.want(true);
  const AcquisitionReport report = scan_loop(request, assembler);
  assembler.abort(DropReason::kOther);
  settle(assembler, request.session);
  return report;
}

AcquisitionReport Acquisition::scan_loop(const Request& request, BurstAssembler& assembler) {
  std::vector<Edge> edges;
  DeviceTime known_until{};
  dark_led_frames_ = 0;
  for (;;) {
    auto frame = frame_with_edges(edges, known_until);
    for (const Edge& e : edges) assembler.push_edge(e);
    if (std::any_of(edges.begin(), edges.end(), [](const Edge& e) { return e.kind == EdgeKind::kGate; })) {
      optics_cc_ = hw_.thermal.read().optics_cc.value_or(0);
      pattern_set_ = hw_.projector.pattern_set();
    }
    if (frame && hw_.camera.restarts() != restarts_seen_) {
      if (auto over = measure_again(assembler, request.session)) return *over;
      continue;
    }
    if (frame) {
      sequencer_.on_frame(frame->status == FrameStatus::kSuccess);
      assembler.push_frame(std::move(*frame));
    }
    assembler.edges_known_until(known_until);
    settle(assembler, request.session);
    if (assembler.dark_leaks() >= config_.leaks_to_stuck) {
      return {AcquisitionPhase::kFailed, ReplyStatus::kLedStuck, true};
    }
    if (aborted()) return done();
    if (!frame) {
      if (frame.error().code == ErrorCode::kCancelled) return {AcquisitionPhase::kEnded, ReplyStatus::kOk, false};
      log::error("acquire", "{}", frame.error().message());
      return failed(ReplyStatus::kCamDisconnected);
    }
    if (drain_asked() && !sequencer_.draining()) {
      sequencer_.drain();
      hw_.projector.disarm();
    }
    if (led_failed()) return failed(ReplyStatus::kProjLedFault);
    if ((sequencer_.draining() || sequencer_.limit_reached()) && assembler.under_way() == 0) return done();
    if (const auto over = arm_next(assembler.under_way() > 0)) return *over;
  }
}

/// After a restart of the camera its stamps may mean another instant. Has a value when the acquisition is over.
std::optional<AcquisitionReport> Acquisition::measure_again(BurstAssembler& assembler, ScanTag session) {
  restarts_seen_ = hw_.camera.restarts();
  hw_.projector.disarm();
  light_.want(false);
  assembler.abort(DropReason::kSettling);
  settle(assembler, session);
  const AcquisitionReport measured = run_calibration();
  if (measured.phase != AcquisitionPhase::kDone || aborted()) return measured;
  log::warn("acquire", "camera restarted: its stamps lie {} us behind the exposure now", stamp_delay_.count() / 1000);
  if (auto restarted = hw_.projector.restart(); !restarted) return failed(ReplyStatus::kProjNotReady);
  assembler.camera_restarted(stamp_delay_);
  sequencer_.settle();
  light_.want(true);
  return std::nullopt;
}

/// Has a value when the acquisition is over.
std::optional<AcquisitionReport> Acquisition::arm_next(bool under_way) {
  if (!sequencer_.want_arm()) return std::nullopt;
  if (auto armed = hw_.projector.arm(); !armed) {
    if (armed.error().code != ErrorCode::kCancelled) return failed(ReplyStatus::kProjNotReady);
    if (under_way) return std::nullopt;  // end of a finite source: its last burst is finished first
    return AcquisitionReport{AcquisitionPhase::kEnded, ReplyStatus::kOk, false};
  }
  sequencer_.on_armed();
  return std::nullopt;
}

/// Switched on, yet no current flows.
bool Acquisition::led_failed() {
  const bool dark = hw_.light.enabled() && hw_.light.sensed_ma() == 0;
  dark_led_frames_ = dark ? dark_led_frames_ + 1 : 0;
  return dark_led_frames_ >= config_.dark_led_frames;
}

/// Hands over what the assembler has decided.
void Acquisition::settle(BurstAssembler& assembler, ScanTag session) {
  const std::uint64_t begun = assembler.begun() - begun_seen_;
  begun_seen_ = assembler.begun();
  ledger_.begin(session, begun);
  sequencer_.on_begun(begun);
  for (BurstOutcome& outcome : assembler.take_outcomes()) {
    if (const auto* lost = std::get_if<GivenUpBurst>(&outcome)) {
      ledger_.drop(session, lost->reason);
      log::warn("acquire", "burst {} given up: {}", lost->burst_index, name_of(lost->reason));
      if (needs_restart(lost->reason)) (void)hw_.projector.restart();
      continue;
    }
    auto& burst = std::get<AssembledBurst>(outcome);
    BurstPixels pixels = take_pixels(burst);
    handler_({session, std::move(burst), std::move(pixels), hw_.camera.mode().frame_period, optics_cc_,
              static_cast<std::uint8_t>(pattern_set_)});
  }
}

AcquisitionReport Acquisition::run_self_test() {
  const ProjectorStatus projector = hw_.projector.status();
  if (!projector.ready) return failed(ReplyStatus::kProjNotReady);
  if (projector.sequence_abort) return failed(ReplyStatus::kProjSeqAbort);
  if (projector.watchdog) return failed(ReplyStatus::kProjWatchdog);
  light_.want(true);
  const bool lights_up = hw_.light.sensed_ma() > 0;
  light_.want(false);
  if (aborted()) return done();
  if (hw_.light.sensed_ma() > 0) return {AcquisitionPhase::kFailed, ReplyStatus::kLedStuck, true};
  if (!lights_up) return failed(ReplyStatus::kProjLedFault);
  const AssemblerConfig limits = AssemblerConfig::for_mode(hw_.camera.mode(), stamp_delay_, config_.max_delay_spread);
  for (int good = 0, tries = 0; good < 3; ++tries) {
    auto frame = next_frame();
    if (aborted()) return done();
    if (!frame || tries > 20) return failed(ReplyStatus::kCamTimeout);
    if (frame->status != FrameStatus::kSuccess) continue;
    if (digest(*frame).mean_dn >= limits.dark_max_dn) return {AcquisitionPhase::kFailed, ReplyStatus::kLedStuck, true};
    ++good;
  }
  return hw_.thermal.read().tip_cc ? done() : failed(ReplyStatus::kThermistor);
}

AcquisitionReport Acquisition::run_calibration() {
  // In slow motion two hundred frames would take too long for what they add.
  const auto in_a_second =
      static_cast<std::size_t>(1'000'000'000 / std::max<std::int64_t>(1, hw_.camera.mode().frame_period.count()));
  DelayCalibration calibration(std::clamp<std::size_t>(in_a_second, 10, config_.calibration_frames));
  std::vector<Edge> edges;
  DeviceTime known_until{};
  for (std::size_t frames = 0; !calibration.complete(); ++frames) {
    const auto frame = frame_with_edges(edges, known_until);
    if (aborted()) return done();
    if (!frame || frames > 3 * config_.calibration_frames) return failed(ReplyStatus::kCamTimeout);
    for (const Edge& e : edges) {
      if (e.kind == EdgeKind::kStrobe) calibration.on_strobe(e.t);
    }
    if (frame->status == FrameStatus::kSuccess) calibration.on_frame(frame->t_sensor, frame->exposure_us);
  }
  const auto delay = calibration.result();
  {
    const std::lock_guard lock(mutex_);
    measured_delay_ = delay;
  }
  if (!delay || delay->mad > config_.max_delay_spread) return failed(ReplyStatus::kTsUnstable);
  stamp_delay_ = delay->median;
  return done();
}

}  // namespace enamel::fw
