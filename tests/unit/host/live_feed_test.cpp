// A probe that is killed, restarted or slow while it becomes ready: real DDS, a scripted probe on a thread.
#include "host/ingest/live_feed.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace enamel::host {
namespace {

using proto::Opcode;
using proto::ProbeState;
using proto::ReplyStatus;
using std::chrono::milliseconds;

constexpr std::uint32_t kProbe = 5;

dds::Participant participant() { return *dds::Participant::create({77, "feed-" + std::to_string(getpid())}); }

struct Script {
  milliseconds warm_up{200};
  bool warms = true;            ///< false: WARMUP is refused for good
  bool anew_at_warmup = false;  ///< the first WARMUP is not answered: a new life begins, which knows no session
};

/// One life after another of a probe with as much of the protocol as becoming ready takes.
class ScriptedProbe {
 public:
  explicit ScriptedProbe(Script script)
      : script_(script), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  std::atomic<int> scans_started{0};

 private:
  void run(const std::stop_token& stop) {
    proto::DeviceInfo info;
    info.probe_id = kProbe, info.serial = "SCRIPTED";
    static_cast<void>(infos_.write(info));
    while (!stop.stop_requested()) {
      static_cast<void>(commands_.wait(milliseconds(20)));
      const auto commands = commands_.take();
      for (const auto& command : *commands)
        if (command.valid && command.value.opcode != Opcode::kPing) obey(command.value);
      if (ready_at_ && clock_.now() >= *ready_at_) status_.state = ProbeState::kReady, ready_at_.reset();
      status_.probe_id = kProbe, ++status_.seq;
      static_cast<void>(statuses_.write(status_));
    }
  }

  void obey(const proto::Command& command) {
    if (command.opcode == Opcode::kWarmup && script_.anew_at_warmup) {
      script_.anew_at_warmup = false;
      status_ = {.state = ProbeState::kIdle};
      client_.reset();
      return;
    }
    proto::CommandReply reply;
    reply.probe_id = kProbe, reply.cmd_id = command.cmd_id, reply.client_id = command.client_id;
    reply.status = verdict(command);
    static_cast<void>(replies_.write(reply));
  }

  ReplyStatus verdict(const proto::Command& command) {
    if (command.opcode == Opcode::kSessionOpen) client_ = command.client_id;
    if (client_ != command.client_id) return ReplyStatus::kNotOwner;
    if (command.opcode == Opcode::kWarmup) {
      if (!script_.warms) return ReplyStatus::kBadState;
      if (status_.state == ProbeState::kIdle) ready_at_ = clock_.now() + script_.warm_up;
      status_.state = ProbeState::kWarmup;
    }
    if (command.opcode == Opcode::kScanStart) {
      status_.state = ProbeState::kScanning, status_.session_id = static_cast<std::uint32_t>(command.arg_i[0]);
      ++scans_started;
    }
    return ReplyStatus::kOk;
  }

  Script script_;
  SteadyClock clock_;
  dds::Participant participant_ = participant();
  dds::Writer<proto::DeviceInfo> infos_ = *dds::Writer<proto::DeviceInfo>::create(participant_);
  dds::Writer<proto::Status> statuses_ = *dds::Writer<proto::Status>::create(participant_);
  dds::Writer<proto::CommandReply> replies_ = *dds::Writer<proto::CommandReply>::create(participant_);
  dds::Reader<proto::Command> commands_ = *dds::Reader<proto::Command>::create(participant_);
  proto::Status status_{.state = ProbeState::kIdle};
  std::optional<std::uint32_t> client_;
  std::optional<HostTime> ready_at_;
  std::jthread thread_;
};

class Told final : public FeedSink {
 public:
  Result<void> on_probe(const proto::DeviceInfo&, bool) override { return {}; }
  void on_burst(dds::Received<proto::Burst>, HostTime) override {}
  void on_status(const proto::Status&) override {}
  void on_event(const proto::Event&) override {}
  void on_state(FeedState state, const std::string& message) override {
    scanning_ = state == FeedState::kScanning;
    if (message.find("warming up") != std::string::npos) warming_ = true;
  }

  std::atomic<bool> scanning_{false}, warming_{false};
};

class LiveFeedTest : public testing::Test {
 protected:
  LiveFeedTest() {
    FeedConfig config;
    config.find_timeout = milliseconds(1500), config.lost_timeout = std::chrono::seconds(20);
    config.close_within = milliseconds(100);
    feed = std::make_unique<LiveFeed>(*link, told, config, clock);
  }
  /// Runs the feed until it scans, or its own end.
  Result<void> run_until_scanning() {
    std::stop_source stop;
    std::jthread watch([&](const std::stop_token& done) {
      while (!done.stop_requested() && !told.scanning_) clock.sleep_for(milliseconds(5));
      scanned = told.scanning_.load();
      stop.request_stop();
    });
    return feed->run(stop.get_token());
  }

  SteadyClock clock;
  dds::Participant own = participant();
  std::unique_ptr<ProbeLink> link = *ProbeLink::create(own, {}, clock);
  Told told;
  std::unique_ptr<LiveFeed> feed;
  std::atomic<bool> scanned{false};
};

TEST_F(LiveFeedTest, a_probe_started_anew_while_it_becomes_ready_is_asked_again) {
  ScriptedProbe probe({.anew_at_warmup = true});
  const auto ran = run_until_scanning();
  EXPECT_TRUE(ran.has_value()) << ran.error().message();
  EXPECT_TRUE(scanned);
  EXPECT_EQ(probe.scans_started, 1);
}

TEST_F(LiveFeedTest, a_probe_that_goes_away_before_it_is_ready_may_come_back) {
  auto probe = std::make_unique<ScriptedProbe>(Script{.warm_up = std::chrono::minutes(5)});
  std::jthread kill([&](const std::stop_token& done) {
    while (!done.stop_requested() && !told.warming_) clock.sleep_for(milliseconds(5));
    probe.reset();
    clock.sleep_for(milliseconds(300));
    probe = std::make_unique<ScriptedProbe>(Script{});
  });
  const auto ran = run_until_scanning();
  EXPECT_TRUE(ran.has_value()) << ran.error().message();
  EXPECT_TRUE(scanned);
}

TEST_F(LiveFeedTest, a_tip_may_take_longer_to_warm_up_than_a_probe_to_be_found) {
  ScriptedProbe probe({.warm_up = milliseconds(3000)});
  EXPECT_TRUE(run_until_scanning().has_value());
  EXPECT_TRUE(scanned);
  EXPECT_TRUE(told.warming_) << "and the person at the screen is told";
}

TEST_F(LiveFeedTest, a_probe_that_never_becomes_ready_is_told) {
  ScriptedProbe probe({.warms = false});
  const auto ran = run_until_scanning();
  ASSERT_FALSE(ran.has_value());
  EXPECT_EQ(ran.error().code, ErrorCode::kProbeRefused);
  EXPECT_FALSE(scanned);
}

}  // namespace
}  // namespace enamel::host
