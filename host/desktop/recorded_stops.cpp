#include "host/desktop/recorded_stops.hpp"

#include <utility>
#include <variant>

#include "host/record/axes_readings.hpp"

namespace enamel::host {

Result<std::unique_ptr<RecordedStops>> RecordedStops::open(BurstStream& stream) {
  ENAMEL_TRY_ASSIGN(const auto readings, axes_of(stream));
  return std::unique_ptr<RecordedStops>(new RecordedStops(stream, readings));
}

RecordedStops::RecordedStops(BurstStream& stream, const std::vector<proto::AxesReading>& readings) : stream_(stream) {
  for (const proto::AxesReading& reading : readings) readings_.emplace(reading.burst_index, reading);
  stream_.rewind();
}

/// The next whole burst; null at the end. Damaged places are passed over and told.
std::shared_ptr<const proto::Burst> RecordedStops::next_burst() {
  while (!stopped_.load(std::memory_order_acquire)) {
    paused_.wait(true, std::memory_order_acquire);
    auto record = stream_.next();
    const std::lock_guard lock(mutex_);
    if (!record) {
      damages_.push_back(record.error());
      counts_.lost_so_far(stream_.bursts_lost());
      continue;
    }
    if (!record->has_value()) return nullptr;
    if (counts_.take(**record) != nullptr) {
      ledger_.accepted();
      return std::make_shared<const proto::Burst>(std::get<proto::Burst>(std::move((*record)->value)));
    }
    if (const auto* damaged = std::get_if<proto::Burst>(&(*record)->value)) {
      damages_.push_back(
          {ErrorCode::kCaptureCorrupt, "burst " + std::to_string(damaged->burst_index) + " is inconsistent"});
    }
  }
  return nullptr;
}

Result<std::optional<StopBursts>> RecordedStops::next(const DesktopModel&) {
  StopBursts out;
  std::optional<proto::AxesReading> at;
  for (;;) {
    auto burst = waiting_ ? std::exchange(waiting_, nullptr) : next_burst();
    if (!burst) break;
    const auto reading = readings_.find(burst->burst_index);
    if (reading == readings_.end()) {
      return fail(ErrorCode::kAxesMissing, "of burst " + std::to_string(burst->burst_index));
    }
    if (at && (at->session_id != reading->second.session_id || at->stop != reading->second.stop)) {
      waiting_ = std::move(burst);
      break;
    }
    if (!at) out.angles = angles_of(reading->second);
    at = reading->second;
    out.bursts.push_back(std::move(burst));
  }
  if (out.bursts.empty()) return std::optional<StopBursts>();
  return std::optional(std::move(out));
}

void RecordedStops::stop() {
  stopped_.store(true, std::memory_order_release);
  set_paused(false);
}

void RecordedStops::set_paused(bool paused) {
  paused_.store(paused && !stopped_.load(std::memory_order_acquire), std::memory_order_release);
  paused_.notify_all();
}

BurstCounts RecordedStops::counts() const {
  const std::lock_guard lock(mutex_);
  return ledger_.counts();
}

std::vector<Error> RecordedStops::damages() const {
  const std::lock_guard lock(mutex_);
  return damages_;
}

}  // namespace enamel::host
