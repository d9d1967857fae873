// The part of a live session that goes on with an earlier one.
#include <filesystem>

#include "host/session/live_session.hpp"
#include "host/session/probe_counts.hpp"
#include "host/session/recorded_counts.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::host {

std::string LiveSession::checkpoint_file() const {
  return checkpoint_path(std::filesystem::path(config_.recording_path).parent_path().string());
}

void LiveSession::open_checkpoint() {
  if (config_.recording_path.empty() || !config_.preview_model) return;
  const std::string path = checkpoint_file();
  if (!config_.resume.empty()) {
    const auto bytes = read_file(path);
    const auto before = bytes ? parse_checkpoint(*bytes) : Result<ModelCheckpoint>(tl::unexpected(bytes.error()));
    if (before) {
      model_before_.put(as_preview(*before));
      knows_model_before_ = true;
    } else if (bytes) {
      log::warn("session", "{}: {}; the model comes back as its recording is worked through", path,
                before.error().detail);
    }
  }
  checkpoint_ = std::make_unique<CheckpointWriter>(path, config_.checkpoint_period);
}

void LiveSession::close_checkpoint() {
  if (!checkpoint_) return;
  checkpoint_.reset();
  std::error_code ec;
  std::filesystem::remove(checkpoint_file(), ec);
}

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
