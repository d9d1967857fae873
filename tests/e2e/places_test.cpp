// Files and folders as they are met outside: full, in use, used before, named in another encoding, littered, damaged.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

/// The first bursts of the small recording, as a folder.
class Places : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({program("enamel"), "capture", "cut", small_capture(), few_, "--last", "3"}).code, 0);
  }
  Ran replay(const std::string& out) {
    return run({program("enamel"), "replay", few_, "--out", out, "--headless", "--fast"}, seconds(120));
  }
  TempFolder tmp_;
  std::string few_ = tmp_ / "few.mcap";
};

TEST_F(Places, results_that_a_full_disk_swallows_are_no_success) {
  for (const char* what : {"capture info --json", "capture verify", "config"}) {
    const std::string command = in_quotes(program("enamel")) + " " + what +
                                (std::string(what) == "config" ? "" : " " + in_quotes(few_)) + " > /dev/full";
    const Ran ran = shell(command);
    EXPECT_EQ(ran.code, 2) << what;
    EXPECT_NE(ran.err.find("standard output"), std::string::npos) << what << ran.err;
  }
  EXPECT_EQ(shell(in_quotes(program("enamel")) + " config | head -n 1").code, 0)
      << "a reader that goes away is no error";
}

TEST_F(Places, names_in_another_encoding_give_a_report_all_the_same) {
  const std::string folder = tmp_ / "Praxis M\xfcller {} %s";
  const Ran ran = replay(folder);
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto text = read_file(folder + "/report.json");
  ASSERT_TRUE(text);
  EXPECT_FALSE(nlohmann::json::parse(*text, nullptr, false).is_discarded());
}

TEST_F(Places, a_folder_that_is_in_use_is_refused) {
  const std::string out = tmp_ / "out";
  fs::create_directories(out);
  const int held = ::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(held, LOCK_EX | LOCK_NB), 0);
  const Ran ran = replay(out);
  EXPECT_EQ(ran.code, 2) << ran.err;
  EXPECT_NE(ran.err.find("another run"), std::string::npos) << ran.err;
  EXPECT_TRUE(fs::is_empty(out));
  ::close(held);
  EXPECT_EQ(replay(out).code, 0) << "control: free again";
}

TEST_F(Places, nothing_of_a_run_before_is_left_among_the_results) {
  const std::string out = tmp_ / "out";
  fs::create_directories(out + "/segments/01");
  const std::vector<std::string> of_before{"deviation.png", "export.obj", "export.obj.json", "segments/01/mesh.ply"};
  for (const std::string& name : of_before) ASSERT_TRUE(write_file(out + "/" + name, "old"));
  ASSERT_TRUE(write_file(out + "/notes.txt", "mine"));
  ASSERT_TRUE(write_file(out + "/segments/mine.txt", "mine"));
  ASSERT_EQ(replay(out).code, 0);
  for (const std::string& name : of_before) EXPECT_FALSE(read_file(out + "/" + name).value_or("") == "old") << name;
  EXPECT_EQ(read_file(out + "/notes.txt").value_or(""), "mine");
  EXPECT_EQ(read_file(out + "/segments/mine.txt").value_or(""), "mine");
}

TEST_F(Places, what_operating_systems_leave_in_folders_is_no_data) {
  const std::string folder = tmp_ / "folder";
  ASSERT_EQ(run({program("enamel"), "capture", "export", few_, folder}).code, 0);
  fs::create_directories(folder + "/__MACOSX/frames");
  fs::create_directories(folder + "/@eaDir");
  const std::vector<std::string> litter{".DS_Store",         "frames/._000000_0.png", "Thumbs.db",
                                        "__MACOSX/frames/x", "@eaDir/thumb.jpg",      "rig.json~",
                                        ".bursts.csv.swp",   ".~lock.bursts.csv#",    "desktop.ini"};
  for (const std::string& name : litter) ASSERT_TRUE(write_file(folder + "/" + name, "x"));
  ASSERT_TRUE(write_file(folder + "/notes.txt", "mine"));
  ASSERT_EQ(run({program("enamel"), "capture", "import", folder, tmp_ / "in.mcap"}).code, 0);
  const Ran info = run({program("enamel"), "capture", "info", tmp_ / "in.mcap"});
  EXPECT_NE(info.out.find("notes.txt"), std::string::npos) << "control: what is of somebody travels along";
  for (const std::string& name : litter) EXPECT_EQ(info.out.find(name), std::string::npos) << name;
}

TEST_F(Places, a_damaged_recording_is_read_and_repaired_as_far_as_it_is_whole) {
  auto bytes = slurp(few_);
  bytes[300'000] ^= 4U;  // in the first chunk
  spill(tmp_ / "damaged.mcap", bytes);
  const Ran replayed = run(
      {program("enamel"), "replay", tmp_ / "damaged.mcap", "--out", tmp_ / "r", "--headless", "--fast"}, seconds(120));
  EXPECT_EQ(replayed.code, 4) << replayed.err;
  const auto report = nlohmann::json::parse(read_file(tmp_ / "r/report.json").value_or("{}"), nullptr, false);
  EXPECT_EQ(report["bursts"]["captured"], 4);
  EXPECT_EQ(report["bursts"]["incomplete"], 1);
  EXPECT_EQ(replayed.err.find("defect of this program"), std::string::npos) << replayed.err;

  const Ran repaired = run({program("enamel"), "capture", "repair", tmp_ / "damaged.mcap", tmp_ / "r.mcap", "--json"});
  EXPECT_EQ(repaired.code, 4) << repaired.err;
  const auto told = nlohmann::json::parse(repaired.out, nullptr, false);
  EXPECT_EQ(told["bursts"], 3);
  EXPECT_EQ(told["missing"], 1);
  EXPECT_EQ(told["problems"].size(), 1U);
  EXPECT_EQ(run({program("enamel"), "capture", "verify", tmp_ / "r.mcap"}).code, 0);

  const Ran over = run({program("enamel"), "capture", "repair", few_, tmp_ / "r.mcap"});
  EXPECT_EQ(over.code, 2) << "what is there is not replaced";
  EXPECT_EQ(run({program("enamel"), "capture", "repair", few_, few_, "--force"}).code, 2) << "nor is the source";
  EXPECT_EQ(run({program("enamel"), "capture", "repair", few_, tmp_ / "r.mcap", "--force"}).code, 0);
}

}  // namespace
}  // namespace enamel::test
