// Takes the stops of a desktop scan: moves the table, waits until it stands, takes bursts of a live probe that were
// exposed after that, and moves on. The probe scans from the first stop to the last; what it takes in between is
// counted and left out.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "host/desktop/exposures.hpp"
#include "host/desktop/rest_window.hpp"
#include "host/desktop/take_counts.hpp"
#include "host/ingest/live_feed.hpp"
#include "host/motion/axes.hpp"
#include "host/session/disk_guard.hpp"
#include "host/session/recorder.hpp"
#include "protocol/types/axes.hpp"

namespace enamel::host {

struct StopTakerConfig {
  ProbeLinkConfig link{};
  /// Give every scan a session_id of its own. close_within: a twin's table makes its pictures late.
  FeedConfig feed{.close_within = Nanoseconds{10'000'000'000}};
  int bursts = 4;                            ///< at every stop, of each exposure
  ExposureConfig exposures{};                ///< at every stop
  Nanoseconds move_within{90'000'000'000};   ///< a whole turn takes 24 s at the usual feed
  Nanoseconds burst_within{30'000'000'000};  ///< from burst to burst of a table that stands
  Nanoseconds start_within{90'000'000'000};  ///< until the probe scans, warming up included
  std::string recording_path{};              ///< empty: none
  std::string program{};                     ///< "enamel 0.1.0"
  std::string config_text{};                 ///< resolved configuration, attached to the recording
  DiskLimits disk{};                         ///< of the recording
  DiskGuard::FreeBytes free_bytes{};         ///< as DiskGuard's
};

struct TakenStop {
  std::uint32_t stop = 0;                                     ///< counted from 0 within the scan
  motion::AxesPosition position{};                            ///< commanded and read while the bursts were taken
  std::vector<std::shared_ptr<const proto::Burst>> bursts{};  ///< in the order of their exposures
};

struct TakeSummary {
  TakeCounts counts;
  std::vector<proto::AxesReading> angles;          ///< of every burst taken, in order
  std::optional<Error> broken_off = std::nullopt;  ///< why the link to the probe ended before finish()
  std::optional<Error> recording_error = std::nullopt;
};

/// One thread owns it and calls the axes; request_stop(), set_paused() and what tells of its progress may come from
/// any. A thread of its own, "ingest", follows the probe.
class StopTaker final : private FeedSink {
 public:
  /// `axes` homed by the caller; they and `clock` must outlive it. kDds.
  [[nodiscard]] static Result<std::unique_ptr<StopTaker>> create(const dds::Participant& participant,
                                                                 const StopTakerConfig& config, motion::Axes& axes,
                                                                 Clock& clock);
  ~StopTaker() override;

  /// Finds the probe, makes it scan; the clocks have been compared then. Once. Errors: those of LiveFeed, of the rig
  /// and of the recording's file; kCancelled.
  [[nodiscard]] Result<proto::DeviceInfo> start();

  /// One stop with config.bursts bursts, and as many of each exposure beside the probe's own that it needs, written to
  /// the recording with their angles, which are published as well. An exposure that the probe refuses is told and left
  /// out. After an error the table stands, nothing of the stop was taken, and unless probe or axes are gone or the disk
  /// is full take() may be called again. Errors: those of the axes; kProbeLost, also when it was started anew while a
  /// recording is written (its light stays off then); kFileWrite when the recording's disk is nearly full; kCancelled.
  [[nodiscard]] Result<TakenStop> take(const motion::AxesAngles& target);

  /// Paused, the probe's light is off and take() waits before its next move or burst, its deadlines standing still. A
  /// move under way is finished.
  void set_paused(bool paused) noexcept;
  [[nodiscard]] bool is_paused() const noexcept { return paused_.load(); }
  /// Makes the call that is running and all later ones return kCancelled, the table standing. Also from a signal
  /// handler.
  void request_stop() noexcept;

  /// Into the recording, where there is one; between start() and finish().
  void attach(const std::string& name, const std::string& media_type, const std::string& bytes);
  /// Ends the probe's session, closes the recording. Once, after start() whatever it returned.
  [[nodiscard]] TakeSummary finish();

  [[nodiscard]] TakeCounts counts() const;
  [[nodiscard]] FeedState feed_state() const;
  /// Bursts that the stop under way has so far.
  [[nodiscard]] int bursts_at_stop() const;
  /// For people: that the recording's disk is nearly full, or empty.
  [[nodiscard]] std::string disk_warning() const;

 private:
  StopTaker(std::unique_ptr<ProbeLink> link, dds::Writer<proto::AxesReading> readings, const StopTakerConfig& config,
            motion::Axes& axes, Clock& clock);
  void end_feed();
  [[nodiscard]] Result<void> check_going() const;
  [[nodiscard]] Result<void> wait_while_paused();
  [[nodiscard]] Result<void> wait_for_bursts();
  [[nodiscard]] Result<void> take_further_exposures();
  /// Of what arrives from now on, so many bursts more, exposed so; 0: as the probe does by itself.
  void want(std::uint32_t exposure_us);
  [[nodiscard]] bool is_refused(std::uint32_t exposure_us) const;
  /// A probe in a new life numbers its bursts as the recording's are: with the lock held.
  [[nodiscard]] bool ends_here() const { return has_restarted_ && recorder_ != nullptr; }
  [[nodiscard]] Error silent() const;
  /// The bursts of the stop that was taken, or all of them back as spare ones.
  [[nodiscard]] std::vector<dds::Received<proto::Burst>> close_window(bool is_taken);
  void note_left_out(const proto::Burst& burst, BurstPlace place);
  [[nodiscard]] TakenStop keep(std::vector<dds::Received<proto::Burst>> bursts, const motion::AxesPosition& position);
  [[nodiscard]] Result<void> start_recorder(const proto::DeviceInfo& info, const std::string& rig_text);

  Result<void> on_probe(const proto::DeviceInfo& info, bool came_back) override;
  void on_restart() override;
  void on_burst(dds::Received<proto::Burst> burst, HostTime arrival) override;
  void on_status(const proto::Status& status) override;
  void on_event(const proto::Event& event) override;
  void on_state(FeedState state, const std::string& message) override;
  void on_exposure(std::uint32_t exposure_us, const Result<void>& done) override;

  StopTakerConfig config_;
  motion::Axes& axes_;
  Clock& clock_;
  std::unique_ptr<ProbeLink> link_;
  dds::Writer<proto::AxesReading> readings_;  ///< told to whoever listens, beside the recording
  LiveFeed feed_;
  std::atomic<bool> paused_{false}, stop_requested_{false};
  std::uint32_t stops_ = 0;
  std::vector<proto::AxesReading> angles_;

  mutable std::mutex mutex_;            // guards all below but the thread
  std::unique_ptr<Recorder> recorder_;  ///< set once, before the first burst
  std::unique_ptr<DiskGuard> disk_;     ///< with it
  LossLedger ledger_;
  RestWindow window_;
  std::vector<dds::Received<proto::Burst>> at_stop_;
  std::uint64_t moving_ = 0, spare_ = 0;
  std::size_t wanted_ = 0;       ///< bursts that the stop shall have
  std::uint32_t wanted_us_ = 0;  ///< bursts exposed otherwise are spare; 0: none are
  std::set<std::uint32_t> refused_us_;
  std::optional<proto::DeviceInfo> probe_;
  FeedState feed_state_ = FeedState::kWaiting;
  bool knows_clock_ = false, has_restarted_ = false, has_ended_ = false;
  std::optional<Error> feed_error_;

  std::jthread ingest_thread_;
};

}  // namespace enamel::host
