// The stops of a live scan: a plan says where, the taker goes there.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "host/desktop/stop_plan.hpp"
#include "host/desktop/stop_source.hpp"
#include "host/desktop/stop_taker.hpp"

namespace enamel::host {

class LiveStops final : public StopSource {
 public:
  /// `taker` has been started; the axes that it moves outlive this.
  LiveStops(std::unique_ptr<StopTaker> taker, std::unique_ptr<StopChooser> plan)
      : taker_(std::move(taker)), plan_(std::move(plan)) {}

  [[nodiscard]] Result<std::optional<StopBursts>> next(const DesktopModel& so_far) override;
  void stop() override { taker_->request_stop(); }
  void set_paused(bool paused) override { taker_->set_paused(paused); }
  /// Bursts of a moving table, and those that a stop had no need of, are shed.
  [[nodiscard]] BurstCounts counts() const override;
  [[nodiscard]] std::optional<PlanOutcome> plan() const override { return plan_->outcome(); }
  [[nodiscard]] std::string progress() const override;
  [[nodiscard]] std::optional<Error> recording_error() const override;
  [[nodiscard]] std::vector<Error> damages() const override { return {}; }

 private:
  void finish();

  std::unique_ptr<StopTaker> taker_;
  std::unique_ptr<StopChooser> plan_;
  mutable std::mutex mutex_;  // guards what follows
  std::string doing_;
  std::size_t taken_ = 0;
  std::optional<TakeSummary> summary_;
};

}  // namespace enamel::host
