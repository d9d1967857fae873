#include "host/desktop/desktop_session.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/desktop/desktop_report.hpp"
#include "host/session/temp_range.hpp"

namespace enamel::host {
namespace {

constexpr std::size_t kTold = 3;  // slips by name; the report has all

/// A table that is off at every few stops is not the one of this mount.json, whatever each stop looks like.
Error told_of(const std::vector<std::string>& slips, std::size_t stops) {
  if (slips.size() > kTold && 4 * slips.size() > stops) {
    return {ErrorCode::kMountForeign,
            std::to_string(slips.size()) + " of " + std::to_string(stops) +
                " stops are not where the axes of this mount put them; the first: " + slips.front()};
  }
  std::string all;
  for (std::size_t n = 0; n < std::min(slips.size(), kTold); ++n) all += (n == 0 ? "" : "; ") + slips[n];
  if (slips.size() > kTold) all += "; and " + std::to_string(slips.size() - kTold) + " more in report.json";
  return {ErrorCode::kAxesStep, all};
}

}  // namespace

DesktopSession::DesktopSession(DesktopModel model, std::unique_ptr<StopSource> source, DesktopRun run, Clock& clock)
    : model_(std::move(model)), source_(std::move(source)), run_(std::move(run)), clock_(clock), rig_(model_.rig()) {}

DesktopSession::~DesktopSession() { stop(); }

void DesktopSession::start() {
  thread_ = std::jthread([this] { run(); });
}

void DesktopSession::set_scanning(bool wanted) {
  wanted_.store(wanted, std::memory_order_release);
  source_->set_paused(!wanted);
}

void DesktopSession::run() {
  const HostTime begun = clock_.now();
  if (const auto taken = take_stops(); !taken) failed_ = taken.error();
  laying_.store(true, std::memory_order_release);
  const HostTime taken_at = clock_.now();
  const auto seconds = [](HostTime from, HostTime to) { return std::chrono::duration<double>(to - from).count(); };
  if (auto laid = model_.finish(scan_)) {
    const auto plan = source_->plan();
    scan_.desktop_json = desktop_json(model_, *laid, {seconds(begun, taken_at), seconds(taken_at, clock_.now())}, plan);
    scan_.desktop_line = desktop_line(*laid, plan);
    for (const pipeline::Slip& slip : laid->slips) scan_.slips.push_back(slip.text());
    shown_.model = std::make_shared<const ModelSnapshot>(model_.snapshot());
    preview_.put(std::make_shared<const BurstPreview>(shown_));
  } else {
    finished_ = tl::unexpected<Error>(failed_.value_or(laid.error()));
  }
  scan_.seconds = seconds(begun, clock_.now());
  ended_.store(true, std::memory_order_release);
}

Result<void> DesktopSession::take_stops() {
  for (;;) {
    ENAMEL_TRY_ASSIGN(const auto stop, source_->next(model_));
    if (!stop) return {};
    for (const auto& burst : stop->bursts) take_in(*burst, scan_.temp_c);
    show(model_.add(*stop));
  }
}

void DesktopSession::show(const MeasuredStop& stop) {
  const auto bad = static_cast<std::uint64_t>(
      std::ranges::count_if(stop.bursts, [](const StopBurst& burst) { return !burst.rejected.empty(); }));
  taken_.fetch_add(stop.bursts.size() - bad, std::memory_order_relaxed);
  turned_away_.fetch_add(bad, std::memory_order_relaxed);
  shown_.burst = stop.bursts.back().id;
  shown_.placed = true;
  shown_.track = bad == stop.bursts.size() ? TrackState::kLost : TrackState::kTracking;
  shown_.T_model_cam = pipeline::pose_by_axes(model_.mount(), stop.angles);
  shown_.rejected = stop.bursts.back().rejected;
  shown_.live = model_.live_image();
  shown_.surface_distance_mm = stop.distance_mm;
  if (run_.preview_model) shown_.model = std::make_shared<const ModelSnapshot>(model_.snapshot());
  preview_.put(std::make_shared<const BurstPreview>(shown_));
}

PreviewFrame DesktopSession::view() const {
  PreviewFrame out;
  out.state = laying_.load(std::memory_order_acquire) ? ScanState::kRefining
              : scanning_wanted()                     ? ScanState::kScanning
                                                      : ScanState::kPaused;
  out.simulated = run_.simulated;
  out.message = source_->progress();
  out.counters = counters_of(source_->counts());
  out.counters.fused = taken_.load(std::memory_order_relaxed);
  out.counters.rejected = turned_away_.load(std::memory_order_relaxed);
  return out;
}

Result<Outcome> DesktopSession::finish() {
  if (thread_.joinable()) thread_.join();
  ENAMEL_TRY(finished_);
  Outcome out;
  out.scan = std::move(scan_);
  out.counts = source_->counts();
  out.counts.fused = out.scan.fused;
  out.counts.rejected = out.scan.rejected;
  out.simulated = run_.simulated;
  out.device_serial = run_.device_serial;
  out.scanned_at = run_.scanned_at;
  out.damages = source_->damages();
  out.recording_error = source_->recording_error();
  out.broken_off = failed_;
  if (!out.broken_off && !out.scan.slips.empty()) {
    out.broken_off = told_of(out.scan.slips, model_.stops().size());
  }
  return out;
}

}  // namespace enamel::host
