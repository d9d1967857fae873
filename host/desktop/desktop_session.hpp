// A desktop scan as the program sees it: stops come from a source, one after the other, the model grows as the axes say
// and is laid anew in the end.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/desktop/desktop_model.hpp"
#include "host/desktop/stop_source.hpp"
#include "host/session/session.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::host {

struct DesktopRun {
  bool simulated = false;
  std::string device_serial, scanned_at;  ///< as Outcome
  bool preview_model = true;              ///< mesh the growing model for a window
};

class DesktopSession final : public Session {
 public:
  DesktopSession(DesktopModel model, std::unique_ptr<StopSource> source, DesktopRun run, Clock& clock);
  ~DesktopSession() override;

  void start() override;
  void stop() override { source_->stop(); }
  void set_scanning(bool wanted) override;
  [[nodiscard]] bool scanning_wanted() const override { return wanted_.load(std::memory_order_acquire); }
  [[nodiscard]] bool ended() const override { return ended_.load(std::memory_order_acquire); }
  [[nodiscard]] PreviewFrame view() const override;
  [[nodiscard]] PreviewSlot* preview() override { return &preview_; }
  [[nodiscard]] std::shared_ptr<const PipelineFigures> figures() const override { return nullptr; }
  [[nodiscard]] std::optional<calib::Rig> rig() const override { return rig_; }
  /// Slips that were found are `broken_off` with kAxesStep, whatever else is well: the model is kept, and told of.
  [[nodiscard]] Result<Outcome> finish() override;

 private:
  void run();
  [[nodiscard]] Result<void> take_stops();
  void show(const MeasuredStop& stop);

  DesktopModel model_;
  std::unique_ptr<StopSource> source_;
  DesktopRun run_;
  Clock& clock_;
  calib::Rig rig_;
  PreviewSlot preview_;
  std::atomic<bool> wanted_{true}, ended_{false}, laying_{false};
  std::atomic<std::uint64_t> taken_{0}, turned_away_{0};
  BurstPreview shown_;           ///< the thread's
  ScanResult scan_;              ///< the thread's, then the owner's
  std::optional<Error> failed_;  ///< of the source: what came before is kept
  Result<void> finished_;
  std::jthread thread_;  // last: ends before what it uses
};

}  // namespace enamel::host
