// The live chain with its real processes: enamel-probe and enamel over Cyclone DDS on loopback.
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <thread>

#include "tests/e2e/live_scan.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

TEST(Live, every_burst_is_accounted_for_and_the_session_replays_to_the_same_bits) {
  const TempFolder tmp;
  const std::string tag = unique_tag();
  const auto probe = start_probe(tmp, tag, "P1");
  const Ran scan = run(scan_command(tmp, tag), seconds(120));
  ASSERT_EQ(scan.code, 0) << scan.err;
  const auto live = report_of(tmp / "session");
  EXPECT_EQ(live["bursts"]["captured"], 40);
  EXPECT_EQ(live["bursts"]["lost_on_wire"], 0);
  EXPECT_EQ(live["bursts"]["incomplete"], 0);
  EXPECT_GT(live["bursts"]["fused"].get<int>(), 0);
  expect_balanced(live["bursts"]);
  for (const char* file : {"mesh.stl", "mesh.ply", "poses.csv", "preview.png", "capture.mcap"}) {
    EXPECT_TRUE(fs::exists(tmp / (std::string("session/") + file))) << file;
  }

  const Ran replay =
      run({program("enamel"), "replay", tmp / "session", "--out", tmp / "again", "--headless", "--threads", "1"},
          seconds(120));
  ASSERT_EQ(replay.code, 0) << replay.err;
  const auto again = report_of(tmp / "again");
  EXPECT_EQ(again["hash"], live["hash"]);
  EXPECT_EQ(again["bursts"], live["bursts"]) << "the recording tells the same story of losses";
  const Ran diff = run({program("enamel"), "capture", "diff", tmp / "session", tmp / "again"});
  EXPECT_EQ(diff.code, 0) << diff.out;
}

TEST(Live, two_probes_are_named_and_one_can_be_chosen) {
  const TempFolder tmp;
  const std::string tag = unique_tag();
  const auto first = start_probe(tmp, tag, "LEFT");
  const auto second = start_probe(tmp, tag, "RIGHT");
  std::this_thread::sleep_for(seconds(2));
  const Ran ambiguous = run(scan_command(tmp, tag), seconds(60));
  EXPECT_EQ(ambiguous.code, 3);
  EXPECT_NE(ambiguous.err.find("LEFT"), std::string::npos) << ambiguous.err;
  EXPECT_NE(ambiguous.err.find("RIGHT"), std::string::npos) << ambiguous.err;
  EXPECT_NE(ambiguous.err.find("--probe"), std::string::npos) << "no remedy:\n" << ambiguous.err;
  auto chosen = scan_command(tmp, tag);
  chosen.insert(chosen.end(), {"--probe", "RIGHT"});
  EXPECT_EQ(run(chosen, seconds(120)).code, 0);
}

TEST(Live, a_killed_probe_is_reported_the_model_kept_and_scanning_goes_on) {
  const TempFolder tmp;
  const std::string tag = unique_tag();
  auto probe = start_probe(tmp, tag, "P1", "100");
  auto scan = app::ChildProcess::start(scan_command(tmp, tag), {tmp / "out", tmp / "err"});
  ASSERT_TRUE(scan);
  SteadyClock clock;
  const auto said = [&](const std::string& words) {
    for (int i = 0; i < 600; ++i) {
      if (read_file(tmp / "err").value_or("").find(words) != std::string::npos) return true;
      clock.sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  };
  clock.sleep_for(seconds(5));
  probe.signal(SIGKILL);
  EXPECT_TRUE(said("probe lost")) << read_file(tmp / "err").value_or("");
  const auto returned = start_probe(tmp, tag, "P1", "1");
  const int code = scan->wait(clock, seconds(120)).value_or(-1);
  const auto report = report_of(tmp / "session");
  ASSERT_TRUE(report.contains("bursts")) << code << read_file(tmp / "err").value_or("");
  // Whether the kill hit a burst that the host knew to be begun is chance; that exit code and report agree is not.
  const bool lossy = report["bursts"]["lost_on_wire"].get<int>() + report["bursts"]["incomplete"].get<int>() > 0;
  EXPECT_EQ(code, lossy ? 4 : 0) << report["bursts"] << read_file(tmp / "err").value_or("");
  EXPECT_GT(report["bursts"]["captured"].get<int>(), 40) << "both lives count";
  EXPECT_GT(report["mesh"]["triangles"].get<int>(), 1000);
  expect_balanced(report["bursts"]);
}

TEST(Live, interrupt_ends_a_scan_with_its_files_written) {
  const TempFolder tmp;
  const std::string tag = unique_tag();
  const auto probe = start_probe(tmp, tag, "P1", "100");
  auto scan = app::ChildProcess::start(scan_command(tmp, tag), {tmp / "out", tmp / "err"});
  ASSERT_TRUE(scan);
  SteadyClock clock;
  clock.sleep_for(seconds(6));
  scan->signal(SIGINT);
  const int code = scan->wait(clock, seconds(60)).value_or(-1);
  const auto bursts = report_of(tmp / "session")["bursts"];
  EXPECT_EQ(code, 0) << bursts << read_file(tmp / "err").value_or("");
  EXPECT_EQ(bursts["lost_on_wire"], 0) << bursts;
  EXPECT_EQ(bursts["incomplete"], 0) << "a burst that is half received when the user interrupts is finished first";
  EXPECT_TRUE(fs::exists(tmp / "session/mesh.stl"));
  expect_balanced(bursts);
}

TEST(Live, a_paced_replay_keeps_to_recorded_time_and_accounts_for_what_it_sheds) {
  const TempFolder tmp;
  SteadyClock clock;
  const HostTime begun = clock.now();
  const Ran paced = run({program("enamel"), "replay", small_capture(), "--out", tmp / "paced", "--headless", "--paced"},
                        seconds(120));
  ASSERT_EQ(paced.code, 0) << paced.err;
  EXPECT_GT(clock.now() - begun, std::chrono::milliseconds(1500)) << "39 periods of 40 ms";
  const auto report = report_of(tmp / "paced");
  EXPECT_EQ(report["bursts"]["captured"], 40);
  EXPECT_GT(report["bursts"]["fused"].get<int>(), 0);
  expect_balanced(report["bursts"]);
}

}  // namespace
}  // namespace enamel::test
