// Poses of a target as they come from a live probe: the link's bursts, gathered into still poses.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "calib/guide/pose_gatherer.hpp"
#include "host/ingest/ingress_gate.hpp"
#include "host/ingest/live_feed.hpp"

namespace enamel::app {

/// What the probe says of itself; settled before the first pose.
struct ProbeSeen {
  calib::Rig rig;           ///< nominal, of mode multi, with noise
  calib::PixelNoise noise;  ///< of one frame
  double saturation_dn = 255;
  bool is_simulated = false;
};

struct PoseNews {
  std::optional<calib::PoseFrames> frames;  ///< empty: the target moved too early …
  int sweeps = 0;                           ///< … after so many
};

struct PoseFeedConfig {
  std::string serial;  ///< empty: the only probe there is
  double wait_seconds = 15;
  int sweeps = 4;
};

/// A thread of its own follows the probe; take() and the rest from one other thread.
class PoseFeed final : private host::FeedSink {
 public:
  /// Starts at once. Errors: kDds.
  [[nodiscard]] static Result<std::unique_ptr<PoseFeed>> create(const dds::Participant& participant,
                                                                const PoseFeedConfig& config, Clock& clock);
  ~PoseFeed() override;

  [[nodiscard]] std::optional<ProbeSeen> probe() const;
  [[nodiscard]] std::optional<PoseNews> take() { return news_.try_pop(); }
  /// The probe's session is over, or error() says why nothing more will come.
  [[nodiscard]] bool ended() const { return ended_.load(std::memory_order_acquire); }
  /// kProbeNotFound, kProbeLost, kRigMissing, kRigInvalid, kPatternSet …
  [[nodiscard]] std::optional<Error> error() const;
  /// Sweeps dropped because a burst of theirs never came. After stop().
  [[nodiscard]] std::uint64_t broken_sweeps() const { return gatherer_ ? gatherer_->broken_sweeps() : 0; }
  /// Poses that went unseen because those before them were not taken in time: the oldest goes first.
  [[nodiscard]] std::uint64_t dropped_poses() const { return dropped_.load(std::memory_order_relaxed); }
  /// Mean over the bursts, degrees C; empty before the first. After stop().
  [[nodiscard]] std::optional<double> temp_c() const;
  /// Ends the session and waits for it.
  void stop();

 private:
  PoseFeed(std::unique_ptr<host::ProbeLink> link, const PoseFeedConfig& config, const host::FeedConfig& feed,
           Clock& clock);
  void run(const std::stop_token& stop);

  Result<void> on_probe(const proto::DeviceInfo& info, bool came_back) override;
  void on_burst(dds::Received<proto::Burst> burst, HostTime arrival) override;
  void on_status(const proto::Status&) override {}
  void on_event(const proto::Event&) override {}
  void on_state(host::FeedState, const std::string&) override {}

  PoseFeedConfig config_;
  std::unique_ptr<host::ProbeLink> link_;
  host::LiveFeed feed_;
  std::optional<calib::PoseGatherer> gatherer_;  ///< feed thread only
  double temp_sum_c_ = 0;                        ///< of so many bursts; feed thread only
  std::uint64_t bursts_ = 0;

  /// A pose is some 50 MB of pictures, and measuring one takes as long as showing the next.
  static constexpr std::size_t kWaitingPoses = 4;
  host::IngressGate<PoseNews> news_{kWaitingPoses, host::GatePolicy::kShedOldest};
  std::atomic<std::uint64_t> dropped_{0};

  mutable std::mutex mutex_;  ///< guards the next two
  std::optional<ProbeSeen> probe_;
  std::optional<Error> error_;
  std::atomic<bool> ended_{false};
  std::jthread thread_;
};

}  // namespace enamel::app
