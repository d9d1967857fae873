// What a scan promises whatever happens around it: killed, stopped, hung up, begun again.
#include <signal.h>

#include <filesystem>
#include <functional>

#include "protocol/base/sha256.hpp"
#include "tests/e2e/live_scan.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uintmax_t kSomeBursts = 6'000'000;  // bytes of recording: about eight bursts

std::string fingerprint(const std::string& path) { return RollingHash().update(read_file(path).value_or("")).hex(); }

bool wait_until(const std::function<bool()>& done) {
  SteadyClock clock;
  for (int i = 0; i < 600 && !done(); ++i) clock.sleep_for(milliseconds(50));
  return done();
}

bool recorded(const std::string& session, std::uintmax_t bytes) {
  std::error_code ec;
  return wait_until([&] {
    const auto size = fs::file_size(session + "/capture.mcap", ec);
    return !ec && size > bytes;
  });
}

std::size_t session_parts_of(const std::string& session) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(session)) count += entry.path().extension() == ".mcap" ? 1U : 0U;
  return count;
}

class Promises : public ::testing::Test {
 protected:
  app::ChildProcess scan() {
    auto child = app::ChildProcess::start(scan_command(tmp_, tag_), {tmp_ / "out", tmp_ / "err"});
    EXPECT_TRUE(child);
    return std::move(*child);
  }
  /// `sleeper` is the host or a probe that plays 240 bursts.
  void expect_to_go_on_after_sleep_of(const app::ChildProcess& sleeper, app::ChildProcess& host) {
    ASSERT_TRUE(recorded(session_, kSomeBursts)) << said();
    sleeper.signal(SIGSTOP);
    clock_.sleep_for(milliseconds(3500));  // longer than the probe's lease and its liveliness
    sleeper.signal(SIGCONT);
    const int code = host.wait(clock_, seconds(90)).value_or(-1);
    EXPECT_TRUE(code == 0 || code == 4) << code << said();
    const auto bursts = report_of(session_)["bursts"];
    expect_balanced(bursts);
    EXPECT_EQ(bursts["captured"], 240) << said();
  }
  [[nodiscard]] std::string said() const { return read_file(tmp_ / "err").value_or(""); }
  TempFolder tmp_;
  std::string tag_ = unique_tag();
  std::string session_ = tmp_ / "session";
  SteadyClock clock_;
};

TEST_F(Promises, a_killed_scan_is_resumed_and_equals_the_replay_of_the_whole) {
  const auto probe = start_probe(tmp_, tag_, "P1", "4");
  auto first = scan();
  ASSERT_TRUE(recorded(session_, kSomeBursts)) << said();
  first.signal(SIGKILL);
  EXPECT_EQ(first.wait(clock_, seconds(10)).value_or(-1), 128 + SIGKILL);

  const Ran again =
      run({program("enamel"), "scan", "--headless", "--resume", session_, "--dds-tag", tag_}, seconds(120));
  ASSERT_TRUE(again.code == 0 || again.code == 4) << again.err;
  const auto live = report_of(session_);
  expect_balanced(live["bursts"]);
  EXPECT_EQ(live["bursts"]["captured"], 160) << "what the probe began while nobody listened is counted, once";
  EXPECT_TRUE(fs::exists(session_ + "/capture-2.mcap"));

  const Ran replay = run({program("enamel"), "replay", session_, "--out", tmp_ / "again", "--headless"}, seconds(120));
  ASSERT_TRUE(replay.code == 0 || replay.code == 4) << replay.err;
  const auto replayed = report_of(tmp_ / "again");
  EXPECT_EQ(replayed["hash"], live["hash"]);
  EXPECT_EQ(replayed["bursts"], live["bursts"]);

  // Control: the first part alone is another result.
  const Ran part = run({program("enamel"), "replay", session_ + "/capture.mcap", "--out", tmp_ / "part", "--headless"},
                       seconds(120));
  EXPECT_NE(report_of(tmp_ / "part")["hash"], live["hash"]) << part.err;
}

TEST_F(Promises, the_next_scan_goes_on_with_one_that_a_crash_broke_off) {
  const auto probe = start_probe(tmp_, tag_, "P1", "4");
  auto first = scan();
  ASSERT_TRUE(recorded(session_, kSomeBursts)) << said();
  // Control: one that is under way is not gone on with.
  EXPECT_EQ(run(scan_command(tmp_, tag_)).code, 2);
  first.signal(SIGKILL);
  ASSERT_TRUE(first.wait(clock_, seconds(10)));
  const Ran again = run(scan_command(tmp_, tag_), seconds(120));
  ASSERT_TRUE(again.code == 0 || again.code == 4) << again.err;
  EXPECT_NE(again.err.find("broken off"), std::string::npos) << again.err;
  EXPECT_TRUE(fs::exists(session_ + "/capture-2.mcap"));
  EXPECT_EQ(report_of(session_)["bursts"]["captured"], 160);
  // Control: one that came to its end is not gone on with either.
  EXPECT_EQ(run(scan_command(tmp_, tag_)).code, 2);
  EXPECT_FALSE(fs::exists(session_ + "/capture-3.mcap"));
}

TEST_F(Promises, a_scan_that_was_broken_off_long_ago_or_is_not_wanted_stays_as_it_is) {
  fs::create_directories(session_);
  const std::string whole = read_file(small_capture()).value_or("");
  ASSERT_TRUE(write_file(session_ + "/capture.mcap", whole.substr(0, whole.size() / 2)));
  auto command = scan_command(tmp_, tag_);
  command.insert(command.end(), {"--wait-seconds", "1"});
  EXPECT_EQ(run(command).code, 3) << "gone on with: no probe is there";
  command.emplace_back("--new");
  EXPECT_EQ(run(command).code, 2) << "the folder holds a recording";
  command.pop_back();
  fs::last_write_time(session_ + "/capture.mcap", fs::file_time_type::clock::now() - std::chrono::minutes(10));
  const Ran late = run(command);
  EXPECT_EQ(late.code, 2) << late.err;
  EXPECT_NE(late.err.find("10 minutes ago"), std::string::npos) << late.err;
  EXPECT_EQ(session_parts_of(session_), 1U);
}

TEST_F(Promises, a_host_that_slept_goes_on) {
  const auto probe = start_probe(tmp_, tag_, "P1", "6");
  auto host = scan();
  expect_to_go_on_after_sleep_of(host, host);
  EXPECT_TRUE(fs::exists(session_ + "/mesh.stl"));
}

TEST_F(Promises, a_probe_that_slept_is_counted_as_one) {
  auto probe = start_probe(tmp_, tag_, "P1", "6");
  auto host = scan();
  expect_to_go_on_after_sleep_of(probe, host);
}

// Sooner than its liveliness lapses: what it says tells, for it knows of no session.
TEST_F(Promises, a_probe_killed_and_back_at_once_is_scanned_on) {
  auto probe = start_probe(tmp_, tag_, "P1", "6");
  auto host = scan();
  ASSERT_TRUE(recorded(session_, kSomeBursts)) << said();
  probe.signal(SIGKILL);
  ASSERT_TRUE(probe.wait(clock_, seconds(10)));
  const auto second = start_probe(tmp_, tag_, "P1");
  const int code = host.wait(clock_, seconds(90)).value_or(-1);
  EXPECT_TRUE(code == 0 || code == 4) << code << said();
  const auto bursts = report_of(session_)["bursts"];
  expect_balanced(bursts);
  EXPECT_GT(bursts["captured"], 40) << "all of the second, some of the first";
}

TEST_F(Promises, a_closed_terminal_ends_a_scan_with_its_files_written) {
  const auto probe = start_probe(tmp_, tag_, "P1", "100");
  auto host = scan();
  ASSERT_TRUE(recorded(session_, kSomeBursts)) << said();
  host.signal(SIGHUP);
  EXPECT_EQ(host.wait(clock_, seconds(60)).value_or(-1), 0) << said();
  EXPECT_TRUE(fs::exists(session_ + "/mesh.stl"));
  EXPECT_EQ(run({program("enamel"), "capture", "verify", session_ + "/capture.mcap"}).code, 0);
}

TEST_F(Promises, a_recording_is_not_written_over) {
  fs::create_directories(session_);
  fs::copy_file(small_capture(), session_ + "/capture.mcap");
  const std::string before = fingerprint(session_ + "/capture.mcap");
  const Ran second = run(scan_command(tmp_, tag_));
  EXPECT_EQ(second.code, 2) << second.err;
  EXPECT_NE(second.err.find("--resume"), std::string::npos) << second.err;
  EXPECT_EQ(fingerprint(session_ + "/capture.mcap"), before);

  const Ran nothing = run({program("enamel"), "scan", "--headless", "--resume", tmp_ / "none", "--dds-tag", tag_});
  EXPECT_EQ(nothing.code, 2) << nothing.err;
}

TEST_F(Promises, a_scan_without_a_folder_gets_a_new_one_and_leaves_none_behind_for_nothing) {
  const std::string command =
      "cd '" + (tmp_ / "") + "' && exec '" + program("enamel") + "' scan --headless --wait-seconds 1 --dds-tag " + tag_;
  EXPECT_EQ(shell(command).code, 3);
  EXPECT_TRUE(fs::is_empty(tmp_ / "out")) << "no probe, no session";
  const auto probe = start_probe(tmp_, tag_, "P1", "1");
  const std::string scan =
      "cd '" + (tmp_ / "") + "' && exec '" + program("enamel") + "' scan --headless --dds-tag " + tag_;
  ASSERT_EQ(shell(scan, seconds(90)).code, 0);
  EXPECT_TRUE(fs::is_symlink(tmp_ / "out/session"));
  EXPECT_TRUE(fs::exists(tmp_ / "out/session/capture.mcap"));
  EXPECT_TRUE(fs::read_symlink(tmp_ / "out/session").string().starts_with("session-20"));
}

}  // namespace
}  // namespace enamel::test
