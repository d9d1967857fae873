// The part of a live session that goes on with an earlier one.
#include "host/session/live_session.hpp"
#include "host/session/probe_counts.hpp"
#include "host/session/recorded_counts.hpp"

namespace enamel::host {

// The same records in the same order as a replay of the whole recording: the same bits.
void LiveSession::rebuild(BurstNumbering& numbering) {
  RecordedCounts counts(ledger_);
  const std::uint64_t total = past_->info().bursts;
  std::uint64_t done = 0;
  for (;;) {
    auto record = past_->next();
    if (record && !*record) break;
    std::shared_ptr<const proto::Burst> burst;
    {
      const std::lock_guard lock(mutex_);
      if (!record) {
        damages_.push_back(record.error());
        counts.lost_so_far(past_->bursts_lost());
        if (record.error().code == ErrorCode::kFileRead) break;
        continue;
      }
      if (counts.take(**record) == nullptr) continue;
      ledger_.accepted();
      burst = std::make_shared<const proto::Burst>(std::get<proto::Burst>(std::move((*record)->value)));
      view_.message = "rebuilding the model: burst " + std::to_string(++done) + " of " + std::to_string(total);
    }
    const BurstId id = numbering.number(*burst);
    pipeline_->push({id, std::move(burst), std::nullopt});
  }
  const std::lock_guard lock(mutex_);
  resumed_session_ = counts.session_id();
  // It came while the model was being rebuilt.
  if (resumed_session_ && status_before_ && status_before_->session_id == *resumed_session_)
    ledger_.probe_status(counts_of(*status_before_));
  view_.message.clear();
  rebuilt_.store(true, std::memory_order_release);
  feed_.set_scanning(wanted_after_rebuild_);
}

void LiveSession::enter_session(std::uint32_t session_id) {
  if (!resumed_session_ || session_id != config_.feed.session_id) return;
  ledger_.probe_restarted();
  resumed_session_.reset();
}

}  // namespace enamel::host
