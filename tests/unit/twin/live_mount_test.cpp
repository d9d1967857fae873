// Where the table stands while a controller drives it, against the scene's own drive, and faults of the axes.
#include "tools/twin/mount/live_mount.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "protocol/base/rng.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/twin/axes/pseudo_terminal.hpp"
#include "tools/twin/degrees.hpp"
#include "tools/twin/live_table.hpp"

namespace enamel::twin::testing {
namespace {

MountConfig some_unit() {
  MountConfig c;
  c.draw = true;
  c.rotation.stop_error_deg = c.swing.stop_error_deg = 0.01;
  return c;
}

/// Tells a mount of straight movements and rests, a word every fraction of a millisecond or few, as a busy machine
/// does.
class Driver {
 public:
  Driver(LiveMount& mount, std::uint64_t seed) : mount_(mount), rng_(seed, 0, 0) {}

  void home(double rot_deg, double swing_deg) {
    motors_.homings = ++homings_;
    motors_.deg = {rot_deg, swing_deg};
    rest();
  }
  /// The middle of the rest that follows.
  HostTime go_to(double rot_deg, double swing_deg) {
    const std::array from = motors_.deg, to{rot_deg, swing_deg};
    ++motors_.movements;
    began_ = motors_.at;
    const int words = 5 + static_cast<int>(rng_.below(40));
    for (int i = 1; i <= words; ++i) {
      const double share = static_cast<double>(i) / words;
      for (std::size_t k = 0; k < 2; ++k) motors_.deg[k] = i == words ? to[k] : from[k] + share * (to[k] - from[k]);
      say();
    }
    ended_ = motors_.at;
    rest();
    return ended_ + (motors_.at - ended_) / 2;
  }
  void forget() { motors_.homings = 0; }
  void rest() {
    for (int i = 0; i < 20; ++i) say();
  }
  HostTime began_{}, ended_{};

 private:
  void say() {
    motors_.at += Nanoseconds{static_cast<std::int64_t>(rng_.uniform(0.2e6, 8e6))};
    mount_.motors_at(motors_);
  }
  LiveMount& mount_;
  Rng rng_;
  int homings_ = 0;
  MotorAngles motors_{host_time(1'000'000'000), {}, 0, 0};
};

/// Largest difference of the two poses' matrices.
double off(const LiveMount& live, HostTime t, const MountRun& run, std::size_t stop) {
  return (T_model_camera(live.mount(), live.at(t).stop).matrix() - T_model_camera(run.mount, run.stops[stop]).matrix())
      .cwiseAbs()
      .maxCoeff();
}

TEST(LiveMount, stands_at_a_stop_where_the_scenes_drive_does) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Rng rng(seed, 1, 0);
    MountConfig config = some_unit();
    double rot = 0, swing = -30;
    for (int i = 0; i < 8; ++i) config.stops.push_back({rot += rng.uniform(1.0, 40.0), swing += rng.uniform(1.0, 7.0)});
    const MountRun run = drive(config, seed);
    LiveMount live(config, seed);
    Driver driver(live, seed);
    driver.home(0, -30);
    for (std::size_t i = 0; i < config.stops.size(); ++i) {
      const HostTime t = driver.go_to(config.stops[i].rot_deg, config.stops[i].swing_deg);
      EXPECT_LT(off(live, t, run, i), 1e-9) << "seed " << seed << ", stop " << i;
      EXPECT_FALSE(live.at(t).is_moving);
      if (i > 0) {
        EXPECT_GT(off(live, t, run, i - 1), 1e-3) << "the comparison sees nothing";
      }
    }
  }
}

TEST(LiveMount, is_on_its_way_while_it_moves) {
  MountConfig config;  // no errors: the shaft is the motor
  LiveMount live(config, 1);
  Driver driver(live, 3);
  driver.home(0, -30);
  driver.go_to(50, 10);
  double last = -1;
  const Nanoseconds way = driver.ended_ - driver.began_;
  for (int i = 1; i < 20; ++i) {
    const TableTruth at = live.at(driver.began_ + way * i / 20);
    EXPECT_TRUE(at.is_moving);
    EXPECT_GT(at.stop.rot, last);
    EXPECT_LT(at.stop.rot, kRadPerDeg * 50);
    last = at.stop.rot;
  }
  EXPECT_FALSE(live.at(driver.began_).is_moving);
  EXPECT_FALSE(live.at(driver.ended_ + Nanoseconds{1}).is_moving);
  EXPECT_EQ(live.at(driver.began_).stop.rot, 0.0);
}

TEST(LiveMount, play_shows_only_where_a_stop_is_reached_from_above) {
  MountConfig config;
  config.rotation.backlash_deg = 0.04;
  LiveMount live(config, 1);
  Driver driver(live, 4);
  driver.home(0, -30);
  const auto rot_deg = [&](HostTime t) { return live.at(t).stop.rot / kRadPerDeg; };
  EXPECT_NEAR(rot_deg(driver.go_to(40, 0)), 40.0, 1e-9);
  EXPECT_NEAR(rot_deg(driver.go_to(30, 0)), 30.04, 1e-9);
  EXPECT_NEAR(rot_deg(driver.go_to(30.03, 0)), 30.04, 1e-9) << "the play is not yet taken up";
  EXPECT_NEAR(rot_deg(driver.go_to(29, 0)), 29.04, 1e-9);
  EXPECT_NEAR(rot_deg(driver.go_to(31, 0)), 31.0, 1e-9);
}

TEST(LiveMount, a_lost_step_stays_until_homing_and_an_unknown_position_moves_nothing) {
  LiveMount live(MountConfig{}, 1, {.movement = 2});
  Driver driver(live, 5);
  const auto rot_deg = [&](HostTime t) { return live.at(t).stop.rot / kRadPerDeg; };
  driver.forget();
  EXPECT_EQ(rot_deg(driver.go_to(200, 0)), 0.0) << "before homing";
  driver.home(0, -30);
  EXPECT_NEAR(rot_deg(driver.go_to(30, -30)), 28.2, 1e-9);
  const HostTime t = driver.go_to(60, -30);
  EXPECT_NEAR(rot_deg(t), 58.2, 1e-9);
  EXPECT_NEAR(live.at(t).stop.rot_cmd / kRadPerDeg, 60, 1e-9) << "the motor's count knows nothing of it";
}

TEST(LiveMount, homing_finds_a_lost_step_again) {
  LiveMount live(MountConfig{}, 1, {.movement = 1});
  Driver driver(live, 6);
  driver.home(0, -30);
  EXPECT_NEAR(live.at(driver.go_to(30, -30)).stop.rot / kRadPerDeg, 28.2, 1e-9);
  driver.home(0, -30);
  EXPECT_NEAR(live.at(driver.go_to(20, -30)).stop.rot / kRadPerDeg, 20, 1e-9);
}

TEST(TableFaults, are_read_or_refused_with_the_names_there_are) {
  EXPECT_EQ(parse_table_fault("lose-step@3")->lost.movement, 3);
  EXPECT_EQ(parse_table_fault("hang@12")->movement, 12);
  EXPECT_EQ(parse_table_fault("")->fault, GrblFault::kNone);
  for (const char* text : {"lose-step", "lose-step@", "lose-step@0", "lose-step@-1", "lose-step@2x", "explode@2", "@2",
                           "unplug@99999999999"}) {
    const auto fault = parse_table_fault(text);
    ASSERT_FALSE(fault) << text;
    EXPECT_EQ(fault.error().code, ErrorCode::kUsage);
    EXPECT_NE(fault.error().detail.find("hard-limit@N"), std::string::npos);
  }
}

TEST(PortNames, replace_a_link_that_was_left_and_nothing_else) {
  const test::TempFolder folder;
  const std::string name = folder / "port";
  std::filesystem::create_symlink("/dev/pts/gone", name);
  {
    const auto port = PortName::create(name, "/dev/pts/here");
    ASSERT_TRUE(port);
    EXPECT_EQ(std::filesystem::read_symlink(name), "/dev/pts/here");
    const auto other = PortName::create(name, "/dev/pts/other");
    ASSERT_TRUE(other) << "a second probe takes the name over";
  }
  EXPECT_FALSE(std::filesystem::is_symlink(name));
  std::filesystem::create_directory(name);
  EXPECT_FALSE(PortName::create(name, "/dev/pts/here"));
  EXPECT_TRUE(std::filesystem::is_directory(name));
}

}  // namespace
}  // namespace enamel::twin::testing
