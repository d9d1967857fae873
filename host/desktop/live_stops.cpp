#include "host/desktop/live_stops.hpp"

#include <fmt/format.h>

#include <utility>

namespace enamel::host {

Result<std::optional<StopBursts>> LiveStops::next(const DesktopModel& so_far) {
  const auto target = plan_->next(so_far);
  if (!target) {
    finish();
    return std::optional<StopBursts>();
  }
  const std::vector<pipeline::Slip> slips = so_far.slips();
  {
    const std::lock_guard lock(mutex_);
    const std::string of = plan_->planned() > 0 ? fmt::format(" of {}", plan_->planned()) : std::string();
    doing_ =
        fmt::format("stop {}{}: rotation {:.1f}, swing {:.1f}", taken_ + 1, of, target->rot_deg, target->swing_deg);
    if (!slips.empty()) doing_ += "\n" + slips.back().text();
  }
  auto taken = taker_->take(*target);
  if (!taken) {
    finish();
    // Who stops a scan wants what was taken so far.
    if (taken.error().code == ErrorCode::kCancelled) return std::optional<StopBursts>();
    return tl::unexpected<Error>(taken.error());
  }
  const std::lock_guard lock(mutex_);
  ++taken_;
  const motion::AxesPosition& at = taken->position;
  StopBursts out;
  out.angles = angles_of(
      proto::AxesReading{0, at.commanded.rot_deg, at.commanded.swing_deg, at.read.rot_deg, at.read.swing_deg});
  out.bursts = std::move(taken->bursts);
  return std::optional(std::move(out));
}

void LiveStops::finish() {
  TakeSummary summary = taker_->finish();
  const std::lock_guard lock(mutex_);
  summary_ = std::move(summary);
  doing_.clear();
}

BurstCounts LiveStops::counts() const {
  const TakeCounts of = taker_->counts();
  BurstCounts out;
  out.captured = of.captured;
  out.lost_on_wire = of.lost;
  out.incomplete = of.incomplete;
  out.shed = of.moving + of.spare;
  out.accepted = of.taken;
  return out;
}

std::string LiveStops::progress() const {
  const std::string disk = taker_->disk_warning();
  const std::lock_guard lock(mutex_);
  return disk.empty() ? doing_ : disk + "\n" + doing_;
}

std::optional<Error> LiveStops::recording_error() const {
  const std::lock_guard lock(mutex_);
  return summary_ ? summary_->recording_error : std::nullopt;
}

}  // namespace enamel::host
