// `enamel desktop axes` against a simulated controller: what it prints, how it ends.
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/grbl_model.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

constexpr const char* kQuick = "[motion]\nfeed_deg_per_s = 300.0\nsettle_ms = 20\n[controller]\nbanner_ms = 1500\n";

class DesktopAxes : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_file(profile_, kQuick)); }
  std::vector<std::string> line(const GrblModel& model, std::vector<std::string> arguments) const {
    std::vector<std::string> argv{program("enamel"), "desktop", "axes"};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    argv.insert(argv.end(), {"--port", model.port(), "--profile", profile_});
    return argv;
  }
  Ran axes(const GrblModel& model, std::vector<std::string> arguments) const {
    return run(line(model, std::move(arguments)));
  }
  TempFolder folder_;
  std::string profile_ = folder_ / "grbl.toml";
};

TEST_F(DesktopAxes, info_moves_nothing) {
  const GrblModel model;
  const Ran ran = axes(model, {"info", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["controller"], "Grbl 1.1h");
  EXPECT_EQ(json["state"], "unhomed");
  EXPECT_EQ(json["settings"]["$100"], 800.0);
  EXPECT_EQ(model.moves(), 0);
}

TEST_F(DesktopAxes, move_homes_goes_there_and_tells_where_it_stands) {
  const GrblModel model;
  const Ran ran = axes(model, {"move", "--rot", "90", "--swing", "-15", "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["commanded"]["rot_deg"], 90.0);
  EXPECT_NEAR(json["read"]["swing_deg"].get<double>(), -15.0, 0.002);
  EXPECT_NEAR(model.position()[0], 90.0 - 399.0, 0.002);
  EXPECT_FALSE(model.was_told_to_move_before_home());
}

TEST_F(DesktopAxes, home_and_stop_end_well) {
  const GrblModel model;
  const Ran homed = axes(model, {"home"});
  EXPECT_EQ(homed.code, 0) << homed.err;
  EXPECT_NE(homed.out.find("ready"), std::string::npos) << homed.out;
  EXPECT_EQ(axes(model, {"stop"}).code, 0);
}

TEST_F(DesktopAxes, what_goes_wrong_has_an_exit_code_and_a_remedy) {
  {
    const GrblModel model;
    EXPECT_EQ(axes(model, {"move", "--rot", "400", "--swing", "0"}).code, 2);
    EXPECT_EQ(axes(model, {"move", "--rot", "nan", "--swing", "0"}).code, 2);
    EXPECT_EQ(axes(model, {"move", "--rot", "10"}).code, 1) << "the swing is missing";
    EXPECT_EQ(model.moves(), 0);
  }
  const GrblModel other_steps({.settings = {{100, 1600}}});
  const Ran refused = axes(other_steps, {"info"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("$100 is 1600, expected 800"), std::string::npos) << refused.err;
  const GrblModel stuck({.homing_alarm = 9});
  const Ran failed = axes(stuck, {"home", "--json"});
  EXPECT_EQ(failed.code, 3);
  EXPECT_NE(failed.err.find("no switch found"), std::string::npos) << failed.err;
  EXPECT_NE(failed.err.find("axes stopped with an alarm"), std::string::npos)
      << "not in words of the probe: " << failed.err;
  EXPECT_EQ(nlohmann::json::parse(failed.out)["error"], "kAxesAlarm");
}

TEST_F(DesktopAxes, ctrl_c_brings_the_table_to_a_stand) {
  ASSERT_TRUE(write_file(profile_, "[motion]\nfeed_deg_per_s = 10.0\n"));
  const GrblModel model;
  auto child = app::ChildProcess::start(line(model, {"move", "--rot", "300", "--swing", "0"}),
                                        {folder_ / "out", folder_ / "err"});
  ASSERT_TRUE(child);
  SteadyClock clock;
  for (int i = 0; i < 3000 && model.moves() == 0; ++i) clock.sleep_for(std::chrono::milliseconds(5));
  clock.sleep_for(std::chrono::milliseconds(300));
  ASSERT_TRUE(model.is_moving());
  child->signal(SIGINT);
  EXPECT_EQ(child->wait(clock, std::chrono::seconds(10)), 5);
  EXPECT_FALSE(model.is_moving());
  EXPECT_LT(model.position()[0], -300.0) << "it was going to -99";
}

}  // namespace
}  // namespace enamel::test
