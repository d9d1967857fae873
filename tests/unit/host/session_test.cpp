// A recording behind the interface of a scan: it starts, rests, goes on, ends and hands over what became of every
// burst.
#include "host/session/session.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/session/pipeline_figures.hpp"
#include "host/session/replay_session.hpp"
#include "tests/unit/host/bare_stream.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::host {
namespace {

constexpr std::uint32_t kForeign = 7;  // bursts of another calibration: turned away before they are decoded

/// Bursts and, where `damaged` says so, a record that cannot be read.
class MadeUpStream final : public test::BareStream {
 public:
  MadeUpStream(std::uint64_t bursts, std::optional<std::uint64_t> damaged) : bursts_(bursts), damaged_(damaged) {
    info_.bursts = bursts;
    info_.metadata.emplace_back("model", "enamel twin, SIMULATED");
  }
  [[nodiscard]] Result<std::optional<capture::Record>> next() override {
    if (next_ == bursts_) return std::optional<capture::Record>();
    const std::uint64_t n = next_++;
    if (n == damaged_) return fail(ErrorCode::kCaptureCorrupt, "record " + std::to_string(n));
    proto::Burst burst = test::camera_burst(n, 16, 12);
    burst.burst_seq = burst.burst_index = n;
    burst.calib_crc32 = kForeign;
    return std::optional(capture::Record{.value = std::move(burst)});
  }
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept override { return damaged_ && next_ > *damaged_ ? 1 : 0; }
  void rewind() noexcept override { next_ = 0; }

 private:
  std::uint64_t bursts_, next_ = 0;
  std::optional<std::uint64_t> damaged_;
};

struct Played {
  explicit Played(std::uint64_t bursts, std::optional<std::uint64_t> damaged = {}, std::uint32_t ours = kForeign + 1) {
    const auto rig = calib::load_rig(ENAMEL_SOURCE_DIR "/config/rigs/probe.json").value();
    const ReplayConfig config{.pipeline = {}, .calib_crc32 = ours};
    session = ReplaySession::create(std::make_unique<MadeUpStream>(bursts, damaged), rig, config, clock).value();
  }
  void wait_until_ended() {
    while (!session->ended()) clock.sleep_for(Nanoseconds{1'000'000});
  }
  SteadyClock clock;
  std::unique_ptr<Session> session;
};

TEST(ScanPipeline, the_way_to_the_screen_is_measured_of_the_bursts_that_were_shown) {
  const auto rig = calib::load_rig(ENAMEL_SOURCE_DIR "/config/rigs/probe.json").value();
  ManualClock clock;
  const auto result_with = [&](std::uint64_t offset) {
    auto pipeline =
        ScanPipeline::create(rig, {}, {.workers = 0, .preview_model = true, .waiting_room = 16}, clock).value();
    for (std::uint64_t n = 0; n < 10; ++n) {
      pipeline->push({BurstId{n}, std::make_shared<const proto::Burst>(test::camera_burst(n, 16, 12)),
                      host_time(static_cast<std::int64_t>(n) * 1'000'000'000)});
    }
    for (const std::uint64_t n : {1U, 4U, 7U})  // the others were overtaken
      pipeline->shown(BurstId{n + offset}, host_time(static_cast<std::int64_t>(n) * 1'000'000'000 + 40'000'000));
    pipeline->shown(BurstId{1 + offset}, host_time(900'000'000'000));  // was shown before
    PreviewFrame seen;
    pipeline->finish();
    pipeline->wait_drained();
    pipeline->count_into(seen);
    EXPECT_TRUE(pipeline->join());
    return std::pair(pipeline->take_result().pixel_ms, seen.latency_ms);
  };
  const auto [on_screen, shown_ms] = result_with(0);
  EXPECT_NEAR(on_screen.p50, 40, 4) << "classes of the histogram";
  EXPECT_NEAR(on_screen.p99, 40, 4);
  EXPECT_NEAR(shown_ms, 40, 4);
  EXPECT_EQ(result_with(100).first.p99, 0) << "control: bursts that never came in";
}

TEST(Session, bursts_whose_frames_were_not_exposed_alike_are_turned_away) {
  Played played(3, {}, kForeign);  // each frame of test::camera_burst has a gain of its own
  played.session->start();
  played.wait_until_ended();
  const auto outcome = played.session->finish();
  ASSERT_TRUE(outcome) << outcome.error().message();
  EXPECT_EQ(outcome->counts.rejected.at("exposure_changed"), 3U);
}

TEST(Session, a_playback_accounts_for_every_burst_and_says_where_its_time_went) {
  Played played(50);
  EXPECT_EQ(played.session->figures(), nullptr) << "nothing runs yet";
  EXPECT_TRUE(played.session->rig());
  played.session->start();
  played.wait_until_ended();
  EXPECT_EQ(played.session->view().counters.rejected, 50U);
  const auto outcome = played.session->finish();
  ASSERT_TRUE(outcome) << outcome.error().message();
  EXPECT_EQ(outcome->counts.captured, 50U);
  EXPECT_EQ(outcome->counts.rejected.at("foreign_calibration"), 50U);
  EXPECT_TRUE(check(outcome->counts));
  EXPECT_TRUE(outcome->damages.empty());
  EXPECT_TRUE(outcome->simulated);
  const auto json = nlohmann::json::parse(outcome->scan.graph_json);
  EXPECT_EQ(json.at("stages").size(), 8U);
  EXPECT_FALSE(json.at("bottleneck").at("words").get<std::string>().empty());
  ASSERT_EQ(outcome->scan.figures.stages.size(), 4U) << "sources and sinks hand over, they do not work";
  EXPECT_EQ(outcome->scan.figures.stages[0].name, "decode0");
  EXPECT_EQ(outcome->scan.figures.stages[3].name, "fuse");
}

TEST(Session, a_damaged_record_is_told_counted_and_passed_over) {
  Played played(10, 4);
  played.session->start();
  const auto outcome = played.session->finish();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->damages.size(), 1U);
  EXPECT_EQ(outcome->counts.incomplete, 1U);
  EXPECT_EQ(outcome->counts.rejected_total(), 9U);
  EXPECT_FALSE(check(outcome->counts)) << "data was lost";
}

TEST(Session, a_paused_playback_rests_until_it_is_wanted_again) {
  Played played(10);
  played.session->set_scanning(false);
  played.session->start();
  EXPECT_EQ(played.session->view().state, ScanState::kPaused);
  EXPECT_EQ(played.session->view().counters.captured, 0U);
  EXPECT_FALSE(played.session->ended());
  played.session->set_scanning(true);
  played.wait_until_ended();
  EXPECT_EQ(played.session->finish()->counts.captured, 10U);
}

TEST(Session, a_stopped_playback_ends_also_when_paused_and_paused_again) {
  Played played(10);
  played.session->set_scanning(false);
  played.session->start();
  played.session->stop();
  played.session->set_scanning(false);
  played.wait_until_ended();
  const auto outcome = played.session->finish();
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->counts.captured, 0U) << "what was not read does not count";
}

}  // namespace
}  // namespace enamel::host
