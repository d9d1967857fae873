// What a recording says of its bursts' whereabouts, put into a ledger record by record: replay and a scan that is
// resumed count alike. Not thread-safe; the ledger's lock is the caller's.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "host/report/accounting.hpp"
#include "host/session/probe_counts.hpp"
#include "protocol/capture/capture.hpp"

namespace enamel::host {

class RecordedCounts {
 public:
  explicit RecordedCounts(LossLedger& ledger) noexcept : ledger_(ledger) {}

  /// Counts it. The burst, when the record is a whole one: it goes into processing.
  [[nodiscard]] const proto::Burst* take(const capture::Record& record) {
    if (const auto* burst = std::get_if<proto::Burst>(&record.value)) return take_burst(*burst);
    if (const auto* note = std::get_if<proto::ShedNote>(&record.value)) {
      ledger_.received(note->burst_seq);
      ledger_.shed();
    } else if (const auto* status = std::get_if<proto::Status>(&record.value)) {
      if (any_ && status->session_id == last_session_) ledger_.probe_status(counts_of(*status));
    }
    return nullptr;
  }
  /// `lost`: bursts that damaged places have taken along so far, of the whole recording.
  void lost_so_far(std::uint64_t lost) {
    for (; lost_ < lost; ++lost_) {
      ledger_.received_unreadable();
      ledger_.damaged();
    }
  }
  /// Of the last burst.
  [[nodiscard]] std::optional<std::uint32_t> session_id() const noexcept {
    return any_ ? std::optional(last_session_) : std::nullopt;
  }

 private:
  const proto::Burst* take_burst(const proto::Burst& burst) {
    // Another session, or numbers that do not grow: the probe or the host was started anew.
    if (any_ && (burst.session_id != last_session_ || burst.burst_seq <= last_seq_)) ledger_.probe_restarted();
    any_ = true;
    last_seq_ = burst.burst_seq;
    last_session_ = burst.session_id;
    ledger_.received(burst.burst_seq);
    if (proto::is_consistent(burst)) return &burst;
    ledger_.damaged();
    return nullptr;
  }

  LossLedger& ledger_;
  bool any_ = false;
  std::uint64_t last_seq_ = 0;
  std::uint32_t last_session_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace enamel::host
