// enamel desktop scan on the twin as real processes: stops of a plan, from homing to the files.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tests/e2e/live_table.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::json;
using std::chrono::seconds;

constexpr const char* kStopsOfPlan[] = {"20,5", "35,5", "50,5", "65,5"};

Json report_in(const std::string& folder) {
  return Json::parse(read_file(folder + "/report.json").value_or("{}"), nullptr, false);
}

std::string scene() {
  return std::string("rig = \"") + ENAMEL_SOURCE_DIR +
         "/config/rigs/probe.json\"\nseed = 1\n"
         "[object]\ntype = \"plate\"\n[timing]\nburst_rate_hz = 15.0\n[path]\ntype = \"mount\"\n"
         "[mount]\ndraw = true\nrot_deg = [0.0]\nswing_deg = [0.0]\nbursts = 1\nplace_mm = [0.0, 0.0, -4.0]\n"
         "[mount.rotation]\npoint_mm = [27.0, 0.0, 48.0]\nstop_error_deg = 0.01\n"
         "[mount.swing]\nstop_error_deg = 0.01\n";
}

/// A probe with its table, the mount.json of that table, a quick profile.
class Desk {
 public:
  explicit Desk(const std::string& serial, const std::vector<std::string>& arguments = {})
      : serial_(serial + std::to_string(::getpid())), tag_(unique_tag()) {
    EXPECT_TRUE(write_file(file("scene.toml"), scene()));
    const Ran made = run({program("enamel-twin"), "render", file("scene.toml"), "--out", file("set")}, seconds(120));
    EXPECT_EQ(made.code, 0) << made.err;
    std::string profile = read_file(std::string(ENAMEL_SOURCE_DIR) + "/config/desktop/grbl.toml").value_or("");
    const std::string slow = "feed_deg_per_s = 15.0";
    EXPECT_NE(profile.find(slow), std::string::npos);
    profile.replace(profile.find(slow), slow.size(), "feed_deg_per_s = 30.0");
    EXPECT_TRUE(write_file(file("grbl.toml"), profile));
    std::string plan = "rot_deg,swing_deg\n";
    for (const char* stop : kStopsOfPlan) plan += std::string(stop) + "\n";
    EXPECT_TRUE(write_file(file("plan.csv"), plan));
    std::vector<std::string> argv{program("enamel-probe"),
                                  "--twin",
                                  file("scene.toml"),
                                  "--twin-axes",
                                  port(),
                                  "--twin-truth",
                                  file("t.csv"),
                                  "--seed",
                                  "1",
                                  "--serial",
                                  serial_,
                                  "--dds-tag",
                                  tag_};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    auto child = app::ChildProcess::start(argv, {file("probe.out"), file("probe.err")});
    EXPECT_TRUE(child);
    if (child) probe.emplace(std::move(*child));
    for (int i = 0; i < 1200 && !std::filesystem::exists(port()); ++i) clock.sleep_for(std::chrono::milliseconds(50));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] std::string port() const { return file("axes"); }
  [[nodiscard]] std::string mount() const { return file("set/truth/mount_true.json"); }
  [[nodiscard]] std::vector<std::string> scan(const std::string& axes_port, const std::string& tag,
                                              const std::vector<std::string>& more = {}) const {
    std::vector<std::string> argv{program("enamel"), "desktop",        "scan",     "--headless", "--mount",
                                  mount(),           "--port",         axes_port,  "--profile",  file("grbl.toml"),
                                  "--plan",          file("plan.csv"), "--bursts", "2",          "--out",
                                  file("out"),       "--probe",        serial_,    "--dds-tag",  tag};
    argv.insert(argv.end(), more.begin(), more.end());
    return argv;
  }
  [[nodiscard]] std::vector<std::string> scan(const std::vector<std::string>& more = {}) const {
    return scan(port(), tag_, more);
  }
  /// Waits until a burst was exposed with the table at rest beyond this angle.
  [[nodiscard]] bool stands_beyond(double rot_deg) {
    for (int i = 0; i < 1200; ++i, clock.sleep_for(std::chrono::milliseconds(50))) {
      for (const auto& [begin, row] : read_table_truth(file("t.csv"))) {
        if (!row.is_moving && row.rot_motor_deg > rot_deg) return true;
      }
    }
    return false;
  }

  std::optional<app::ChildProcess> probe;
  SteadyClock clock;

 private:
  TempFolder folder_;
  std::string serial_, tag_;
};

TEST(DesktopScanLive, a_plan_is_taken_laid_written_and_replays_to_the_same_bits) {
  const Desk desk("DESK-A-");
  // Two bursts of the probe's exposure and two of a shorter one: a replay has to tell them apart as the scan did.
  const Ran ran = run(desk.scan({"--exposures", "2"}), seconds(150));
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json report = report_in(desk.file("out"));
  const Json& desktop = report["desktop"];
  ASSERT_EQ(desktop["stops"].size(), std::size(kStopsOfPlan)) << report;
  EXPECT_NEAR(desktop["stops"][1]["rotation_deg"].get<double>(), 35, 0.01);
  EXPECT_EQ(desktop["stops"][1]["bursts"], 4);
  EXPECT_EQ(report["bursts"]["fused"], 4 * std::size(kStopsOfPlan));
  EXPECT_TRUE(desktop["slips"].empty()) << desktop["slips"];
  EXPECT_EQ(desktop["plan"]["ended"], "planned");
  EXPECT_EQ(desktop["plan"]["is_complete"], true);
  const Ran again =
      run({program("enamel"), "replay", desk.file("out/capture.mcap"), "--headless", "--out", desk.file("again")},
          seconds(120));
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(report_in(desk.file("again"))["hash"], report["hash"]) << again.err;
  EXPECT_TRUE(report_in(desk.file("again"))["desktop"]["plan"].is_null()) << "a recording does not say";
  EXPECT_TRUE(report["hash"].is_string());
}

TEST(DesktopScanLive, a_lost_step_ends_in_a_warning_that_names_the_stop) {
  const Desk desk("DESK-B-", {"--twin-axes-fault", "lose-step@3"});
  const Ran ran = run(desk.scan(), seconds(150));
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_NE(ran.err.find("the table is not where it says it is"), std::string::npos) << ran.err;
  EXPECT_NE(ran.err.find("from stop 2 on the rotation is off"), std::string::npos) << ran.err;
  const Json report = report_in(desk.file("out"));
  EXPECT_EQ(report["desktop"]["stops"].size(), std::size(kStopsOfPlan));
  EXPECT_EQ(report["desktop"]["stops"][1]["bursts"], 2) << "plain stone needs no further exposure";
  ASSERT_EQ(report["desktop"]["slips"].size(), 1U);
  EXPECT_NEAR(report["desktop"]["slips"][0]["rotation_deg"].get<double>(), -1.8, 0.06);
}

TEST(DesktopScanLive, ctrl_c_keeps_what_was_taken_of_a_part_and_nothing_that_was_placed_before_it) {
  Desk desk("DESK-C-");
  std::string plan = "rot_deg,swing_deg\n";
  for (int k = 1; k <= 20; ++k) plan += std::to_string(15 * k) + ",0\n";
  ASSERT_TRUE(write_file(desk.file("plan.csv"), plan));
  ASSERT_TRUE(make_folder(desk.file("out")));
  for (const char* name : {"out/lower.stl", "out/case.png", "out/notes.stl"})
    ASSERT_TRUE(write_file(desk.file(name), "of before"));
  auto scan = app::ChildProcess::start(desk.scan({"--part", "die-46"}), {desk.file("scan.out"), desk.file("scan.err")});
  ASSERT_TRUE(scan);
  ASSERT_TRUE(desk.stands_beyond(44));  // the third stop: two are taken
  scan->signal(SIGINT);
  EXPECT_EQ(scan->wait(desk.clock, seconds(90)).value_or(-1), 0) << read_file(desk.file("scan.err")).value_or("");
  const Json report = report_in(desk.file("out/die-46"));
  const std::size_t stops = report["desktop"]["stops"].size();
  EXPECT_GE(stops, 2U);
  EXPECT_LT(stops, 20U);
  EXPECT_EQ(report["desktop"]["plan"]["ended"], "stopped");
  EXPECT_EQ(report["desktop"]["plan"]["is_complete"], false);
  EXPECT_EQ(report["bursts"]["fused"], 2 * stops);
  EXPECT_TRUE(std::filesystem::exists(desk.file("out/die-46/capture.mcap")));
  const Json in_case = Json::parse(read_file(desk.file("out/case.json")).value_or("{}"), nullptr, false);
  ASSERT_EQ(in_case["parts"].size(), 1U) << in_case;
  EXPECT_EQ(in_case["parts"][0]["name"], "die-46");
  EXPECT_EQ(in_case["parts"][0]["stops"], stops);
  for (const char* name : {"out/lower.stl", "out/case.png"}) EXPECT_FALSE(std::filesystem::exists(desk.file(name)));
  EXPECT_TRUE(std::filesystem::exists(desk.file("out/notes.stl")));
}

TEST(DesktopScanLive, nothing_moves_without_axes_and_nothing_is_written_without_a_probe) {
  const Desk desk("DESK-D-");
  const Ran no_port = run(desk.scan(desk.file("elsewhere"), unique_tag()));
  EXPECT_EQ(no_port.code, 3) << no_port.err;
  EXPECT_NE(no_port.err.find("axes not usable"), std::string::npos) << no_port.err;
  ASSERT_TRUE(write_file(desk.file("plan.csv"), "rot_deg,swing_deg\n20,5\n500,5\n"));
  const Ran beyond = run(desk.scan());
  EXPECT_NE(beyond.code, 0);
  EXPECT_NE(beyond.err.find("angle outside the range of the axes"), std::string::npos) << beyond.err;
  ASSERT_TRUE(write_file(desk.file("plan.csv"), "rot_deg,swing_deg\n20,5\n"));
  const Ran no_probe = run(desk.scan(desk.port(), unique_tag(), {"--wait-seconds", "2"}));
  EXPECT_EQ(no_probe.code, 3) << no_probe.err;
  EXPECT_NE(no_probe.err.find("no probe found"), std::string::npos) << no_probe.err;
  EXPECT_FALSE(std::filesystem::exists(desk.file("out/report.json")));
}

}  // namespace
}  // namespace enamel::test
