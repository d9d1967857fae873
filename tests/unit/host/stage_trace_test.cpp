#include "host/report/stage_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace enamel::host {
namespace {

StageTrace three_bursts() {
  StageTrace trace;
  for (std::uint64_t i = 0; i < 3; ++i) trace.add({i, {10 + i, 20 + i, 30 + i, 40 + i}, "fused"});
  return trace;
}

TEST(StageTrace, survives_its_file) {
  const auto back = StageTrace::from_csv(three_bursts().to_csv(), "stages.csv");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->to_csv(), three_bursts().to_csv());
  EXPECT_FALSE(first_difference(three_bursts(), *back));
}

TEST(StageTrace, names_the_first_stage_and_burst_that_differ) {
  const StageTrace original = three_bursts();
  StageTrace other;
  for (TraceRow row : original.rows()) {
    if (row.burst_id >= 1) row.digest[2] ^= 1U;
    other.add(row);
  }
  const auto d = first_difference(three_bursts(), other);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->burst_id, 1U);
  EXPECT_EQ(d->stage, "track");
}

TEST(StageTrace, one_flipped_bit_anywhere_changes_the_hash) {
  const StageTrace original = three_bursts();
  const std::string whole = original.hash("mesh");
  for (std::size_t stage = 0; stage < kTracedStages.size(); ++stage) {
    StageTrace other;
    for (TraceRow row : original.rows()) {
      if (row.burst_id == 2) row.digest[stage] ^= 0x8000000000000000U;
      other.add(row);
    }
    EXPECT_NE(other.hash("mesh"), whole) << kTracedStages[stage];
  }
  EXPECT_NE(three_bursts().hash("nesh"), whole);
}

TEST(StageTrace, reports_a_burst_that_one_run_lacks) {
  StageTrace shorter;
  shorter.add(three_bursts().rows()[0]);
  const auto d = first_difference(shorter, three_bursts());
  ASSERT_TRUE(d);
  EXPECT_EQ(d->stage, "presence");
  EXPECT_EQ(d->burst_id, 1U);
}

TEST(StageTrace, a_table_that_a_spreadsheet_saved_is_read) {
  std::string text = "\xef\xbb\xbf" + three_bursts().to_csv();
  std::replace(text.begin(), text.end(), ',', ';');
  const auto back = StageTrace::from_csv(text, "stages.csv");
  ASSERT_TRUE(back) << back.error().detail;
  EXPECT_EQ(back->to_csv(), three_bursts().to_csv());
}

TEST(StageTrace, refuses_a_damaged_file_naming_the_line) {
  std::string text = three_bursts().to_csv();
  text[text.find("000b")] = 'x';
  const auto back = StageTrace::from_csv(text, "stages.csv");
  ASSERT_FALSE(back);
  EXPECT_NE(back.error().detail.find("stages.csv:3"), std::string::npos);
}

}  // namespace
}  // namespace enamel::host
