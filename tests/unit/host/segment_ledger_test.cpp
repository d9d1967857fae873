// What became of segments: chains of joins end in a root, and the report tells each.
#include "host/session/segment_ledger.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "host/report/report.hpp"

namespace enamel::host {
namespace {

Pose shifted(double x) { return Pose(Eigen::Translation3d(x, 0, 0)); }

TrackResult placed_in(SegmentId segment, std::vector<SegmentJoin> joins = {}) {
  TrackResult out;
  out.state = TrackState::kTracking;
  out.segment = segment;
  out.joins = std::move(joins);
  return out;
}

TEST(SegmentLedger, follows_joins_to_the_end) {
  SegmentLedger ledger;
  ledger.placed(BurstId{0}, placed_in(0));
  ledger.placed(BurstId{1}, placed_in(1));
  ledger.placed(BurstId{2}, placed_in(2));
  ledger.placed(BurstId{3}, placed_in(1, {{2, 1, shifted(5)}}));
  EXPECT_EQ(ledger.root_of(2).id, 1U);
  ledger.joined({1, 0, shifted(7)}, std::nullopt);
  EXPECT_EQ(ledger.root_of(2).id, 0U);
  EXPECT_NEAR(ledger.root_of(2).T_root_segment.translation().x(), 12, 1e-12);
  EXPECT_EQ(ledger.root_of(0).id, 0U);
  const auto rows = ledger.rows();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].bursts, 2U) << "with the burst that joined another to it";
  EXPECT_EQ(rows[2].joined_at, BurstId{3});
  EXPECT_FALSE(rows[1].joined_at);
  EXPECT_EQ(*rows[1].into, 0U);
}

TEST(SegmentReport, says_where_each_lies_and_what_to_look_at) {
  Report report;
  report.segments = {{1, 14, 41, 54, 0, 55, ""}, {2, 3, 60, 62, 0, {}, ""}, {3, 4, 70, 73, {}, {}, "segments/03"}};
  const auto json = nlohmann::json::parse(to_json(report)).at("segments");
  EXPECT_EQ(json[0].at("state"), "joined");
  EXPECT_EQ(json[0].at("joined_at"), 55);
  EXPECT_EQ(json[1].at("joined_at"), "end");
  EXPECT_EQ(json[2].at("state"), "apart");
  EXPECT_EQ(json[2].at("folder"), "segments/03");
  EXPECT_FALSE(json[2].contains("into"));
  EXPECT_EQ(segments_line(report.segments), "2 joined, 1 apart (4 bursts): segments/03");
  EXPECT_EQ(segments_line({}), "");
}

}  // namespace
}  // namespace enamel::host
