// Stops of a desktop scanner on the twin as real processes: exposed as they need, and what ends a scan early.
#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>

#include "tests/e2e/live_table.hpp"

namespace enamel::test {
namespace {

using host::TakenStop;
using motion::AxesAngles;
using std::chrono::seconds;

std::vector<std::uint32_t> exposures_of(const TakenStop& stop) {
  std::vector<std::uint32_t> out;
  for (const auto& burst : stop.bursts) out.push_back(burst->meta.front().exposure_us);
  return out;
}

TEST(DesktopTaker, a_dark_object_is_exposed_longer_too_and_the_next_stop_begins_as_before) {
  // Of the light that suits plaster, a thirtieth.
  LiveTable table(7, {}, "exposure_ms = 0.9\n", "[light]\nreference_fraction = 0.02\n");
  table.config.bursts = 2;
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  std::vector<TakenStop> stops;
  for (const double rot : {20.0, 35.0}) {
    auto taken = table.taker->take({rot, 5.0});
    ASSERT_TRUE(taken) << taken.error().message();
    // 4 x 0.9 ms: a frame's period of 4 ms holds it.
    EXPECT_EQ(exposures_of(*taken), (std::vector<std::uint32_t>{900, 900, 3600, 3600}));
    stops.push_back(std::move(*taken));
  }
  EXPECT_EQ(table.wrong_poses(stops), 0);
  const double darker = host::light_shares(*stops[0].bursts[0], {}).dim;
  EXPECT_LT(host::light_shares(*stops[0].bursts[2], {}).dim, darker) << "it is exposed longer in name only";
  const auto balanced = host::check(table.taker->finish().counts);
  EXPECT_TRUE(balanced) << balanced.error().message();
}

TEST(DesktopTaker, an_exposure_that_the_probe_refuses_is_left_out) {
  LiveTable table(8, {}, "exposure_ms = 0.035\n");
  table.config.bursts = 2;
  table.config.exposures.exposures = 2;  // a quarter of it: below the shortest that there is
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  for (const double rot : {20.0, 30.0}) {
    const auto taken = table.taker->take({rot, 5.0});
    ASSERT_TRUE(taken) << taken.error().message();
    EXPECT_EQ(exposures_of(*taken), (std::vector<std::uint32_t>{35, 35}));
  }
  EXPECT_TRUE(host::check(table.taker->finish().counts));
}

/// A table that needs no port: it stands wherever it is wanted.
class StillAxes final : public motion::Axes {
 public:
  explicit StillAxes(motion::Axes& axes) : limits_(axes.limits()) {}
  [[nodiscard]] motion::AxesLimits limits() const override { return limits_; }
  [[nodiscard]] motion::AxesState state() const override { return motion::AxesState::kReady; }
  [[nodiscard]] Result<void> home(Nanoseconds) override { return {}; }
  [[nodiscard]] Result<motion::AxesPosition> move_to(const AxesAngles& target, Nanoseconds) override {
    at_ = {target, target};
    return at_;
  }
  [[nodiscard]] Result<motion::AxesPosition> position() override { return at_; }
  [[nodiscard]] Result<void> stop() override { return {}; }
  void request_stop() noexcept override {}

 private:
  motion::AxesLimits limits_;
  motion::AxesPosition at_;
};

/// Started with a table that outlives the probe, one stop taken; then the probe is killed and started anew.
void take_a_stop_and_restart(LiveTable& table, std::unique_ptr<StillAxes>& still) {
  table.config.burst_within = seconds(120);  // a busy machine starts it slowly
  const auto started = table.start([&](motion::Axes& own) -> motion::Axes& {
    still = std::make_unique<StillAxes>(own);
    return *still;
  });
  ASSERT_TRUE(started) << started.error().message();
  const auto taken = table.taker->take({20.0, 5.0});
  ASSERT_TRUE(taken) << taken.error().message();
  table.probe->signal(SIGKILL);
  static_cast<void>(table.probe->wait(table.clock, seconds(10)));
  std::filesystem::remove(table.file("truth.csv"));
  table.start_probe();
}

TEST(DesktopTaker, a_probe_started_anew_ends_a_recorded_scan_with_what_it_has_and_stays_dark) {
  LiveTable table(9);
  table.config.recording_path = table.file("capture.mcap");
  std::unique_ptr<StillAxes> still;
  ASSERT_NO_FATAL_FAILURE(take_a_stop_and_restart(table, still));
  const auto next = table.taker->take({30.0, 5.0});
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::kProbeLost);
  EXPECT_NE(next.error().message().find("started anew"), std::string::npos) << next.error().message();
  table.taker->set_paused(true);
  table.taker->set_paused(false);
  table.clock.sleep_for(seconds(3));
  EXPECT_TRUE(table.truth().empty()) << "its light is on, and nobody waits for bursts";
  const auto summary = table.taker->finish();
  EXPECT_EQ(summary.counts.taken, 3U);
  const auto& c = summary.counts;
  EXPECT_EQ(c.captured, c.taken + c.moving + c.spare + c.incomplete + c.lost);
  auto reader = capture::CaptureReader::open(table.file("capture.mcap"));
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().bursts, 3U);
  EXPECT_EQ(reader->info().axes, 3U);
}

TEST(DesktopTaker, a_probe_started_anew_goes_on_where_nothing_is_recorded) {
  LiveTable table(10);
  std::unique_ptr<StillAxes> still;
  ASSERT_NO_FATAL_FAILURE(take_a_stop_and_restart(table, still));
  const auto next = table.taker->take({30.0, 5.0});
  ASSERT_TRUE(next) << next.error().message();
  EXPECT_FALSE(table.truth().empty()) << "the check of the light sees nothing";
  const auto c = table.taker->finish().counts;
  EXPECT_EQ(c.taken, 6U);
  EXPECT_EQ(c.captured, c.taken + c.moving + c.spare + c.incomplete + c.lost);
}

TEST(DesktopTaker, a_disk_that_fills_up_is_told_early_and_ends_the_scan_cleanly) {
  LiveTable table(11);
  table.config.recording_path = table.file("capture.mcap");
  table.config.disk.period = std::chrono::milliseconds(20);
  std::atomic<std::uint64_t> left{table.config.disk.warn_bytes};
  table.config.free_bytes = [&] { return left.load(); };
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  ASSERT_TRUE(table.taker->take({20.0, 5.0}));
  EXPECT_EQ(table.taker->disk_warning(), "");
  EXPECT_TRUE(std::filesystem::exists(table.file(".reserve"))) << "nothing is held back for the results";
  left = table.config.disk.stop_bytes;
  for (int i = 0; i < 500 && table.taker->disk_warning().empty(); ++i)
    table.clock.sleep_for(std::chrono::milliseconds(20));
  EXPECT_NE(table.taker->disk_warning().find("DISK NEARLY FULL: 128 MB"), std::string::npos);
  ASSERT_TRUE(table.taker->take({30.0, 5.0})) << "a warning ends nothing";
  left = table.config.disk.stop_bytes - 1;
  auto full = table.taker->take({40.0, 5.0});
  for (int i = 0; i < 10 && full; ++i) full = table.taker->take({40.0 + i, 5.0});
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kFileWrite);
  EXPECT_NE(full.error().message().find("the disk is nearly full"), std::string::npos) << full.error().message();
  const auto summary = table.taker->finish();
  EXPECT_FALSE(summary.recording_error);
  EXPECT_FALSE(std::filesystem::exists(table.file(".reserve"))) << "the results need it";
  auto reader = capture::CaptureReader::open(table.file("capture.mcap"));
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().bursts, summary.counts.taken);
}

}  // namespace
}  // namespace enamel::test
