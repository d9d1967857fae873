// A desktop scanner on the twin as real processes: stops are taken from a probe whose table a GRBL controller drives.
#include <gtest/gtest.h>
#include <signal.h>

#include <numeric>
#include <thread>

#include "host/record/axes_readings.hpp"
#include "protocol/base/rng.hpp"
#include "tests/e2e/live_table.hpp"

namespace enamel::test {
namespace {

using host::TakenStop;
using motion::AxesAngles;
using std::chrono::seconds;

/// Does not wait for the table: what a taker must not be content with.
class HastyAxes final : public motion::Axes {
 public:
  explicit HastyAxes(motion::Axes& axes) : axes_(axes) {}
  ~HastyAxes() override { join(); }
  [[nodiscard]] motion::AxesLimits limits() const override { return axes_.limits(); }
  [[nodiscard]] motion::AxesState state() const override { return axes_.state(); }
  [[nodiscard]] Result<void> home(Nanoseconds within) override { return axes_.home(within); }
  [[nodiscard]] Result<motion::AxesPosition> move_to(const AxesAngles& target, Nanoseconds within) override {
    join();
    mover_ = std::thread([this, target, within] { static_cast<void>(axes_.move_to(target, within)); });
    at_ = {target, target};
    return at_;
  }
  [[nodiscard]] Result<motion::AxesPosition> position() override { return at_; }
  [[nodiscard]] Result<void> stop() override { return axes_.stop(); }
  void request_stop() noexcept override { axes_.request_stop(); }

 private:
  void join() {
    if (mover_.joinable()) mover_.join();
  }
  motion::Axes& axes_;
  motion::AxesPosition at_;
  std::thread mover_;
};

/// Of first frames; 8-bit levels.
double mean_difference(const proto::Burst& a, const proto::Burst& b) {
  const auto x = proto::frame_bytes(a, 0), y = proto::frame_bytes(b, 0);
  double sum = 0;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) sum += std::abs(int{x[i]} - int{y[i]});
  return sum / static_cast<double>(x.size());
}

void expect_pictures_of_one_pose_a_stop(const std::vector<TakenStop>& stops) {
  double within = 0, across = 1e9;
  for (std::size_t i = 0; i < stops.size(); ++i) {
    for (const auto& burst : stops[i].bursts) {
      within = std::max(within, mean_difference(*stops[i].bursts[0], *burst));
      if (i > 0) across = std::min(across, mean_difference(*stops[i - 1].bursts[0], *burst));
    }
  }
  EXPECT_LT(within, across) << "a burst looks like one of another stop";
}

TEST(DesktopLive, stops_are_taken_of_a_table_at_rest_and_every_burst_is_accounted_for) {
  LiveTable table(1);
  table.config.recording_path = table.file("capture.mcap");
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  Rng rng(7, 0, 0);
  std::vector<TakenStop> stops;
  for (int i = 0; i < 5; ++i) {
    // To and fro, so that some are reached by a detour.
    const AxesAngles target{rng.uniform(1.0, 90.0), rng.uniform(-25.0, 25.0)};
    auto taken = table.taker->take(target);
    ASSERT_TRUE(taken) << taken.error().message();
    EXPECT_EQ(taken->stop, static_cast<std::uint32_t>(i));
    EXPECT_EQ(taken->bursts.size(), 3U);
    EXPECT_EQ(taken->position.commanded.rot_deg, target.rot_deg);
    EXPECT_NEAR(taken->position.read.swing_deg, target.swing_deg, LiveTable::kMotorDeg);
    stops.push_back(std::move(*taken));
  }
  const auto summary = table.taker->finish();
  EXPECT_EQ(table.wrong_poses(stops), 0);
  expect_pictures_of_one_pose_a_stop(stops);
  const auto& c = summary.counts;
  EXPECT_EQ(c.taken, 15U);
  EXPECT_GT(c.moving, 0U);
  const auto balanced = host::check(c);
  EXPECT_TRUE(balanced) << balanced.error().message();
  EXPECT_FALSE(summary.broken_off);
  EXPECT_FALSE(summary.recording_error);

  auto reader = capture::CaptureReader::open(table.file("capture.mcap"));
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().bursts, 15U);
  EXPECT_EQ(reader->info().shed, c.moving + c.spare) << "those left out are noted";
  EXPECT_EQ(reader->info().axes, 15U);
  const auto stream = host::open_bursts(table.file("capture.mcap"));
  ASSERT_TRUE(stream);
  const auto rows = host::axes_of(**stream);
  ASSERT_TRUE(rows) << rows.error().message();
  EXPECT_EQ(*rows, summary.angles);
  for (const auto& row : *rows) {
    const auto burst = reader->next_burst();
    ASSERT_TRUE(burst && *burst);
    EXPECT_EQ((*burst)->burst_index, row.burst_index);
  }
}

TEST(DesktopLive, a_taker_that_does_not_wait_is_caught) {
  LiveTable table(2);
  table.profile.feed_deg_per_s = 6.0;
  std::unique_ptr<HastyAxes> hasty;
  const auto started = table.start([&](motion::Axes& own) -> motion::Axes& {
    hasty = std::make_unique<HastyAxes>(own);
    return *hasty;
  });
  ASSERT_TRUE(started) << started.error().message();
  std::vector<TakenStop> stops;
  auto taken = table.taker->take({150.0, 0.0});  // 25 s away
  ASSERT_TRUE(taken) << taken.error().message();
  stops.push_back(std::move(*taken));
  EXPECT_GT(table.wrong_poses(stops), 0) << "the check sees nothing";
  static_cast<void>(table.taker->finish());
  hasty->request_stop();
  table.probe->signal(SIGKILL);
}

TEST(DesktopLive, a_lost_step_shows_in_the_pictures_and_nowhere_else) {
  LiveTable table(3, {"--twin-axes-fault", "lose-step@2"});
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  for (const double rot : {20.0, 50.0, 80.0}) {
    const auto taken = table.taker->take({rot, 5.0});
    ASSERT_TRUE(taken) << taken.error().message();
    const double lost = rot > 20.0 ? 1.8 : 0.0;
    const auto rows = table.truth();
    for (const auto& burst : taken->bursts) {
      const auto row = rows.find(burst->meta[0].t_strobe_ns);
      ASSERT_NE(row, rows.end());
      EXPECT_NEAR(row->second.rot_motor_deg, rot, LiveTable::kMotorDeg);
      EXPECT_NEAR(row->second.rot_deg, rot - lost, LiveTable::kTableDeg);
    }
    EXPECT_EQ(table.wrong_poses({*taken}) == 0, lost == 0.0);
  }
}

TEST(DesktopLive, an_alarm_ends_the_stop_and_after_homing_it_goes_on) {
  LiveTable table(4, {"--twin-axes-fault", "hard-limit@2"});
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  std::vector<TakenStop> stops;
  auto first = table.taker->take({20.0, 0.0});
  ASSERT_TRUE(first) << first.error().message();
  stops.push_back(std::move(*first));
  const auto failed = table.taker->take({60.0, 0.0});
  ASSERT_FALSE(failed);
  EXPECT_NE(failed.error().message().find("ALARM:1"), std::string::npos) << failed.error().message();
  EXPECT_FALSE(table.taker->take({60.0, 0.0})) << "the position is unknown";
  ASSERT_TRUE(table.axes->home(seconds(20)));
  auto again = table.taker->take({60.0, 0.0});
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_EQ(again->stop, 1U);
  stops.push_back(std::move(*again));
  EXPECT_EQ(table.wrong_poses(stops), 0);
  EXPECT_TRUE(host::check(table.taker->finish().counts));
}

/// Waits until the stop under way has a burst.
bool has_burst(LiveTable& table) {
  for (int i = 0; i < 6000 && table.taker->bursts_at_stop() == 0; ++i)
    table.clock.sleep_for(std::chrono::milliseconds(10));
  return table.taker->bursts_at_stop() > 0;
}

TEST(DesktopLive, a_pause_is_kept_and_a_request_to_stop_ends_the_stop) {
  LiveTable table(5);
  table.config.bursts = 100'000;
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  Result<TakenStop> taken = fail(ErrorCode::kInternal);
  std::thread taking([&] { taken = table.taker->take({15.0, -20.0}); });
  EXPECT_TRUE(has_burst(table));
  const auto reached = [&](host::FeedState state) {
    for (int i = 0; i < 1200 && table.taker->feed_state() != state; ++i)
      table.clock.sleep_for(std::chrono::milliseconds(50));
    return table.taker->feed_state() == state;
  };
  table.taker->set_paused(true);
  EXPECT_TRUE(reached(host::FeedState::kPaused));
  // The burst under way comes; no other does.
  std::size_t exposed = 0;
  for (int i = 0; i < 20 && std::exchange(exposed, table.truth().size()) != table.truth().size(); ++i)
    table.clock.sleep_for(seconds(3));
  EXPECT_EQ(table.truth().size(), exposed) << "bursts go on in a pause";
  table.taker->set_paused(false);
  EXPECT_TRUE(reached(host::FeedState::kScanning));
  table.taker->request_stop();
  taking.join();
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(table.axes->state(), motion::AxesState::kReady);
  EXPECT_FALSE(table.taker->take({15.0, -20.0})) << "stopped for good";
  const auto counts = table.taker->finish().counts;
  EXPECT_EQ(counts.taken, 0U);
  EXPECT_GT(counts.spare, 0U);
  const auto balanced = host::check(counts);
  EXPECT_TRUE(balanced) << balanced.error().message();
}

TEST(DesktopLive, a_probe_that_falls_silent_is_lost) {
  LiveTable table(6);
  table.config.bursts = 100'000;
  table.config.burst_within = seconds(6);
  const auto started = table.start();
  ASSERT_TRUE(started) << started.error().message();
  Result<TakenStop> taken = fail(ErrorCode::kInternal);
  std::thread taking([&] { taken = table.taker->take({15.0, -20.0}); });
  EXPECT_TRUE(has_burst(table));
  table.probe->signal(SIGSTOP);
  taking.join();
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().code, ErrorCode::kProbeLost) << taken.error().message();
  table.probe->signal(SIGCONT);
}

TEST(DesktopLive, the_port_goes_with_the_probe_and_wrong_lines_are_told) {
  const TempFolder tmp;
  const std::string scenes = std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/";
  const auto says = [&](std::vector<std::string> arguments, const std::string& words) {
    arguments.insert(arguments.begin(), program("enamel-probe"));
    const Ran ran = run(arguments, seconds(60));
    EXPECT_GT(ran.code, 0);
    EXPECT_NE(ran.err.find(words), std::string::npos) << ran.err;
  };
  says({"--twin-axes", tmp / "axes", "--play", "x.mcap"}, "goes with --twin");
  says({"--twin", scenes + "desktop_bar.toml", "--twin-truth", tmp / "t"}, "go with --twin-axes");
  says({"--twin", scenes + "desktop_bar.toml", "--twin-axes", tmp / "axes", "--twin-axes-fault", "lose-step"}, "@N");
  says({"--twin", scenes + "plane.toml", "--twin-axes", tmp / "axes"}, "path.type = mount");
  ASSERT_TRUE(write_file(tmp / "taken", "mine"));
  says({"--twin", scenes + "desktop_bar.toml", "--twin-axes", tmp / "taken"}, "choose another name");
  EXPECT_EQ(read_file(tmp / "taken").value_or(""), "mine");
  const Ran ran = run({program("enamel-probe"), "--twin", scenes + "desktop_bar.toml", "--twin-axes", tmp / "axes",
                       "--dds-tag", live_tag(), "--seconds", "1"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(std::filesystem::is_symlink(tmp / "axes"));
}

}  // namespace
}  // namespace enamel::test
