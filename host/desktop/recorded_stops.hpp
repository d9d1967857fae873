// The stops of a recording: bursts that follow each other with the same number of their stop.
#pragma once

#include <atomic>
#include <map>
#include <memory>
#include <mutex>

#include "host/desktop/stop_source.hpp"
#include "host/record/burst_stream.hpp"
#include "host/session/recorded_counts.hpp"

namespace enamel::host {

class RecordedStops final : public StopSource {
 public:
  /// Errors: kAxesMissing, those of axes_of.
  [[nodiscard]] static Result<std::unique_ptr<RecordedStops>> open(BurstStream& stream);

  [[nodiscard]] Result<std::optional<StopBursts>> next(const DesktopModel& so_far) override;
  void stop() override;
  void set_paused(bool paused) override;
  [[nodiscard]] BurstCounts counts() const override;
  [[nodiscard]] std::string progress() const override { return {}; }
  [[nodiscard]] std::vector<Error> damages() const override;

 private:
  RecordedStops(BurstStream& stream, const std::vector<proto::AxesReading>& readings);
  [[nodiscard]] std::shared_ptr<const proto::Burst> next_burst();

  BurstStream& stream_;
  std::map<std::uint64_t, proto::AxesReading> readings_;
  std::shared_ptr<const proto::Burst> waiting_;  ///< the first of the next stop
  std::atomic<bool> stopped_{false}, paused_{false};
  mutable std::mutex mutex_;  // guards what follows
  LossLedger ledger_;
  RecordedCounts counts_{ledger_};
  std::vector<Error> damages_;
};

}  // namespace enamel::host
