// Text and tables as spreadsheets save them.
#include "protocol/base/plain_text.hpp"

#include <gtest/gtest.h>

namespace enamel {
namespace {

constexpr const char* kPlain = "burst_id,t_ns,tx\n0,5,0.5\n1,9,-1.25e-3\n";

std::string utf16(std::string_view text, bool big) {
  std::string out = big ? "\xfe\xff" : "\xff\xfe";
  for (const char c : text) out += big ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

TEST(PlainText, marks_go_and_what_has_none_is_not_copied) {
  std::string room;
  const std::string text = "abc";
  EXPECT_EQ(plain_text(text, room).data(), text.data());
  EXPECT_EQ(plain_text("\xef\xbb\xbf"
                       "abc",
                       room),
            "abc");
  EXPECT_EQ(plain_text(utf16("abc", false), room), "abc");
  EXPECT_EQ(plain_text(utf16("abc", true), room), "abc");
  EXPECT_EQ(plain_text(std::string("\xff\xfe\xf6\x01x\0!", 7), room), "?x");  // no ASCII, half a character
  EXPECT_EQ(plain_text("", room), "");
}

TEST(PlainText, a_table_from_any_spreadsheet_is_the_plain_one) {
  const std::string forms[] = {
      kPlain,
      "\xef\xbb\xbf"
      "burst_id,t_ns,tx\r\n0,5,0.5\r\n1,9,-1.25e-3\r\n",
      "burst_id,t_ns,tx\r0,5,0.5\r1,9,-1.25e-3",
      "burst_id;t_ns;tx\n0;5;0,5\n1;9;-1,25e-3\n",
      "burst_id;t_ns;tx\n0;5;0.5\n1;9;-1.25e-3\n",
      "burst_id\tt_ns\ttx\n0\t5\t0,5\n1\t9\t-1,25e-3\n",
      utf16("burst_id\tt_ns\ttx\r\n0\t5\t0,5\r\n1\t9\t-1,25e-3\r\n", false),
      "\"burst_id\",\"t_ns\",\"tx\"\n\"0\",\"5\",\"0,5\"\n1,9,\"-1,25e-3\"\n",
      "sep=;\r\nburst_id;t_ns;tx\r\n0;5;0,5\r\n1;9;-1,25e-3\r\n",
      "burst_id, t_ns, tx\n 0, 5, 0.5 \n1,\t9, -1.25e-3\n",
      "burst_id;t_ns;tx;;\n0;5;0,5;;\n1;9;-1,25e-3;;\n;;;;\n;;;;\n",
  };
  for (const std::string& form : forms) EXPECT_EQ(plain_table(form), kPlain) << form;
}

TEST(PlainText, what_is_no_number_stays_for_the_reader_to_refuse) {
  EXPECT_EQ(plain_table("a;b\n1.234,5;2\n"), "a,b\n1.234,5,2\n");  // thousands: three fields
  EXPECT_EQ(plain_table("a;b\nx,y;2\n"), "a,b\nx,y,2\n");
  EXPECT_EQ(plain_table("a,b\n1,2,3\n"), "a,b\n1,2,3\n");
  EXPECT_EQ(plain_table("a,b\n1,\n"), "a,b\n1,\n");  // a field is missing
}

TEST(PlainText, lines_keep_their_numbers) {
  EXPECT_EQ(plain_table("a;b\n\n;\n1;2\n"), "a,b\n\n\n1,2\n");
  EXPECT_EQ(plain_table(""), "");
  EXPECT_EQ(plain_table("\xef\xbb\xbf\r\n"), "");
}

}  // namespace
}  // namespace enamel
