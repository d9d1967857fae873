// Follows one probe through a session: finds it, starts the scan, hands over what arrives, notices when the probe dies,
// pauses or comes back. Body of the ingest thread; everything is told to a FeedSink on that thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "host/ingest/probe_link.hpp"

namespace enamel::host {

enum class FeedState : std::uint8_t { kWaiting, kScanning, kPaused, kLost, kEnded };

class FeedSink {
 public:
  virtual ~FeedSink() = default;
  /// A probe was chosen, or the chosen one came back. An error ends the feed.
  [[nodiscard]] virtual Result<void> on_probe(const proto::DeviceInfo& info, bool came_back) = 0;
  /// The probe that came back is in a new life: its counters and burst numbers begin again.
  virtual void on_restart() {}
  virtual void on_burst(dds::Received<proto::Burst> burst, HostTime arrival) = 0;
  virtual void on_status(const proto::Status& status) = 0;
  virtual void on_event(const proto::Event& event) = 0;
  virtual void on_state(FeedState state, const std::string& message) = 0;
  /// The probe exposes as set_exposure() asked, from some burst on that says so itself, or why it does not.
  virtual void on_exposure(std::uint32_t, const Result<void>&) {}
};

struct FeedConfig {
  std::uint32_t session_id = 1;
  bool start_at_once = true;                  ///< false: wait for set_scanning(true)
  Nanoseconds find_timeout{15'000'000'000};   ///< for the first probe; then kProbeNotFound
  Nanoseconds lost_timeout{120'000'000'000};  ///< for a lost probe to come back; then the session ends with what it has
  Nanoseconds settle{300'000'000};            ///< two probes take this long to show themselves both
  Nanoseconds poll_period{10'000'000};
  Nanoseconds left_scanning{500'000'000};   ///< a probe that says so long that it does not scan is asked to again
  Nanoseconds close_within{1'000'000'000};  ///< more than twice what a probe takes to finish a burst
};

class LiveFeed {
 public:
  LiveFeed(ProbeLink& link, FeedSink& sink, const FeedConfig& config, Clock& clock)
      : link_(link), sink_(sink), config_(config), clock_(clock), scanning_wanted_(config.start_at_once) {}

  /// Returns when the probe's session has ended, `stop` is requested, or an error makes going on pointless.
  [[nodiscard]] Result<void> run(const std::stop_token& stop);

  /// From any thread: scan or pause, as the person at the screen wishes.
  void set_scanning(bool wanted) { scanning_wanted_.store(wanted, std::memory_order_release); }
  [[nodiscard]] bool scanning_wanted() const { return scanning_wanted_.load(std::memory_order_acquire); }
  /// From any thread: how long bursts are to be exposed; 0: as the probe does by itself. FeedSink::on_exposure() hears
  /// of it. A session begins with 0; a probe that came back is asked again.
  void set_exposure(std::uint32_t exposure_us) { exposure_wanted_us_.store(exposure_us, std::memory_order_release); }

 private:
  [[nodiscard]] Result<void> wait_for_probe(const std::stop_token& stop, bool came_back);
  [[nodiscard]] Result<void> open_session(const std::stop_token& stop);
  [[nodiscard]] Result<void> take_lease(const std::stop_token& stop);
  /// The probe's newest word, later than those that have come so far.
  [[nodiscard]] Result<proto::Status> fresh_status(const std::stop_token& stop);
  [[nodiscard]] Result<void> wait_ready(const std::stop_token& stop);
  [[nodiscard]] Result<void> ask_to_warm_up(const std::stop_token& stop);
  /// Scanning was asked for and granted, and the probe has gone to rest without an end of its session: it had not heard
  /// from here for longer than its lease (this machine slept, or was stopped or too busy), or was started anew.
  [[nodiscard]] bool probe_left_scanning();
  /// The first session; a probe that goes away before it is ready may come back.
  [[nodiscard]] Result<void> begin(const std::stop_token& stop);
  [[nodiscard]] Result<void> come_back(const std::stop_token& stop, const Error& why);
  [[nodiscard]] Result<void> take_input();
  [[nodiscard]] Result<void> follow_wish();
  [[nodiscard]] Result<void> follow_exposure();
  void close_session();
  void enter(FeedState state, const std::string& message = {});

  ProbeLink& link_;
  FeedSink& sink_;
  FeedConfig config_;
  Clock& clock_;
  std::atomic<bool> scanning_wanted_;
  std::atomic<std::uint32_t> exposure_wanted_us_{0};
  std::uint32_t exposure_asked_us_ = 0;  ///< in this session of the probe
  FeedState state_ = FeedState::kWaiting;
  bool started_ = false;  ///< SCAN_START was accepted in this life of the probe
  bool ever_started_ = false;
  std::optional<HostTime> resting_since_;
  bool ended_ = false;
};

}  // namespace enamel::host
