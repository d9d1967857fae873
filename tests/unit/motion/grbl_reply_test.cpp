#include "host/motion/grbl_reply.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>

#include "host/motion/grbl_text.hpp"
#include "protocol/base/file.hpp"

namespace enamel::motion {
namespace {

TEST(GrblReply, a_status_report_is_read) {
  const GrblReply reply = parse_reply("<Run|MPos:-399.125,-69.000,0.000|Bf:15,128|FS:900,0|Pn:XZ>");
  const auto* status = std::get_if<GrblStatus>(&reply);
  ASSERT_NE(status, nullptr);
  EXPECT_EQ(status->state, GrblState::kRun);
  ASSERT_TRUE(status->has_mpos);
  EXPECT_DOUBLE_EQ(status->mpos[0], -399.125);
  EXPECT_DOUBLE_EQ(status->mpos[1], -69.0);
}

TEST(GrblReply, hold_tells_whether_the_axis_still_slows_down) {
  EXPECT_EQ(std::get<GrblStatus>(parse_reply("<Hold:1|MPos:0.000,0.000,0.000>")).sub, 1);
  EXPECT_EQ(std::get<GrblStatus>(parse_reply("<Hold:0|MPos:0.000,0.000,0.000>")).sub, 0);
}

TEST(GrblReply, work_position_is_not_taken_for_machine_position) {
  EXPECT_FALSE(std::get<GrblStatus>(parse_reply("<Idle|WPos:1.000,2.000,3.000|FS:0,0>")).has_mpos);
}

TEST(GrblReply, every_kind_of_line_is_known) {
  EXPECT_TRUE(std::holds_alternative<GrblOk>(parse_reply("ok")));
  EXPECT_EQ(std::get<GrblError>(parse_reply("error:9")).number, 9);
  EXPECT_EQ(std::get<GrblAlarm>(parse_reply("ALARM:1")).number, 1);
  EXPECT_DOUBLE_EQ(std::get<GrblSetting>(parse_reply("$100=800.000")).value, 800.0);
  EXPECT_DOUBLE_EQ(std::get<GrblSetting>(parse_reply("$100=800.000 (x, step/mm)")).value, 800.0);
  EXPECT_EQ(std::get<GrblBanner>(parse_reply("Grbl 1.1h ['$' for help]")).version, "1.1h");
  EXPECT_EQ(std::get<GrblBanner>(parse_reply("\xfc\x02Grbl 1.1f ['$' for help]")).version, "1.1f")
      << "noise of the start";
  EXPECT_TRUE(std::holds_alternative<GrblNote>(parse_reply("[MSG:Caution: Unlocked]")));
}

TEST(GrblReply, damaged_lines_are_garbled_not_guessed) {
  for (const char* line : {"",
                           "o",
                           "okk",
                           "OK",
                           "error:",
                           "error:x",
                           "ALARM:-1",
                           "ALARM:1 ",
                           "$=1",
                           "$100=",
                           "$100=nan",
                           "<Idle|MPos:1.0,2.0",
                           "<Idle|MPos:1.0,2.0>",
                           "<Idle|MPos:1.0,inf,0.0>",
                           "<Idel|MPos:0,0,0>",
                           "<Idle|MPos:1.0.0,2.0,0.0>",
                           "<Hold:x|MPos:0,0,0>",
                           "<>",
                           "<|>",
                           "Idle",
                           "\x80\xff"}) {
    EXPECT_TRUE(std::holds_alternative<GrblGarbled>(parse_reply(line))) << line;
  }
}

TEST(GrblReply, any_bytes_are_read_without_harm) {
  std::mt19937 random(7);
  const std::string seed = "<Idle|MPos:-399.125,-69.000,0.000|FS:0,0>";
  int sound = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string line = seed;
    for (int k = 0; k < 1 + i % 4; ++k) line[random() % line.size()] = static_cast<char>(random() % 256);
    const GrblReply reply = parse_reply(line);
    const auto* status = std::get_if<GrblStatus>(&reply);
    if (status == nullptr || !status->has_mpos) continue;
    ++sound;
    for (const double v : status->mpos) ASSERT_TRUE(v == v && v < 1e300 && v > -1e300) << line;
  }
  EXPECT_GT(sound, 100) << "some changes are digits";
}

TEST(GrblText, every_alarm_and_error_has_a_meaning_and_a_remedy) {
  std::set<int> numbers;
  for (const auto& table : {grbl_alarms(), grbl_errors()}) {
    numbers.clear();
    for (const GrblText& t : table) {
      EXPECT_TRUE(numbers.insert(t.number).second) << t.number << " stands twice";
      EXPECT_FALSE(t.meaning.empty() || t.remedy.empty()) << t.number;
    }
  }
  EXPECT_NE(alarm_text(1).find("home again"), std::string::npos);
  EXPECT_NE(error_text(9).find("locked"), std::string::npos);
  EXPECT_NE(error_text(77).find("not one of Grbl 1.1"), std::string::npos);
}

TEST(GrblText, the_page_has_every_message_that_a_person_can_mend) {
  const auto page = read_file(std::string(ENAMEL_SOURCE_DIR) + "/docs/desktop.md");
  ASSERT_TRUE(page);
  int rows = 0;
  const auto expect_rows = [&](const char* kind, std::span<const GrblText> table) {
    for (const GrblText& t : table) {
      if (t.remedy.starts_with("the line was damaged")) continue;
      const std::string row = fmt::format("| `{}:{}` | {} | {} |", kind, t.number, t.meaning, t.remedy);
      EXPECT_NE(page->find(row), std::string::npos) << row;
      ++rows;
    }
  };
  expect_rows("ALARM", grbl_alarms());
  expect_rows("error", grbl_errors());
  EXPECT_EQ(page->find("| `ALARM:0` |"), std::string::npos);
  EXPECT_GT(rows, 15);
}

}  // namespace
}  // namespace enamel::motion
