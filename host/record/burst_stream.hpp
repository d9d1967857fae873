// Bursts from wherever they lie: a recording or an exchange folder.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "protocol/capture/capture.hpp"

namespace enamel::host {

/// One thread.
class BurstStream {
 public:
  virtual ~BurstStream() = default;
  /// Of a folder: counts, times and extra files as if it had been imported.
  [[nodiscard]] virtual const capture::CaptureInfo& info() const noexcept = 0;
  [[nodiscard]] virtual const std::string& rig_text() const noexcept = 0;  ///< empty: none recorded
  /// Next burst or shed note or other record in log order, nullopt at the end. A folder holds bursts, and in front of
  /// each its angles where axes.csv has them; their log_ns is the end of the last exposure. Errors: see
  /// CaptureReader::next and ExchangeReader::burst; the next call goes on behind.
  [[nodiscard]] virtual Result<std::optional<capture::Record>> next() = 0;
  /// Bursts that the errors of next() have taken along so far.
  [[nodiscard]] virtual std::uint64_t bursts_lost() const noexcept = 0;
  virtual void rewind() noexcept = 0;
  [[nodiscard]] virtual Result<proto::Burst> burst_with_id(BurstId id) = 0;
  /// Errors: kFileNotFound.
  [[nodiscard]] virtual Result<proto::Bytes> attachment(const std::string& name) = 0;
};

/// A file is a recording, a folder that of a session (all its parts) or an exchange folder. Errors: of
/// CaptureReader::open and ExchangeReader::open.
[[nodiscard]] Result<std::unique_ptr<BurstStream>> open_bursts(const std::string& path);

/// What is in it was rendered, not seen by a probe.
[[nodiscard]] bool says_simulated(const capture::CaptureInfo& info);

/// When a live recording began, UTC; empty for one that does not say.
[[nodiscard]] std::string recorded_at(const capture::CaptureInfo& info);

}  // namespace enamel::host
