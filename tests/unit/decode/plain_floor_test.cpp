// What beside_plain() lets pass and what not.
#include "tests/support/plain_floor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

constexpr int kWidth = 100, kHeight = 100;
constexpr float kDepth_mm = 48, kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kFringeOff_mm = 44.5F;  ///< a fringe nearer

calib::Rig rig() { return cropped_rig(kWidth, kHeight); }
Map<float> plane() { return {kWidth, kHeight, kDepth_mm}; }

/// The plane with this many pixels at another depth.
Map<float> plane_with(int pixels, float depth_mm) {
  Map<float> out = plane();
  for (int i = 0; i < pixels; ++i) out[static_cast<std::size_t>(i)] = depth_mm;
  return out;
}

/// A lit plane; with edges, its last pixel lies beside one.
DepthTruth truth(bool edges = false) {
  DepthTruth out{plane(), Map<std::uint8_t>(kWidth, kHeight, 255), Map<std::uint8_t>(kWidth, kHeight)};
  if (edges) out.edge[out.edge.size() - 1] = 1;
  return out;
}

TEST(PlainFloor, counts_what_is_lit_and_within_the_depth_range) {
  DepthTruth t = truth();
  for (int u = 0; u < kWidth; ++u) {
    t.lit(u, 0) = 0;           // placed, but never asked for
    t.depth_mm(u, 1) = 60;     // beyond the range
    t.depth_mm(u, 2) = kNone;  // nothing there
  }
  const Floor f = floor_of(rig(), t, plane());
  EXPECT_EQ(f.lit, 9700U);
  EXPECT_EQ(f.covered, 9700U);
  EXPECT_EQ(f.placed, 9800U);
  EXPECT_EQ(f.wrong, 0U);
}

TEST(PlainFloor, half_a_fringe_parts_right_from_wrong) {
  EXPECT_EQ(floor_of(rig(), truth(), plane_with(50, kFringeOff_mm)).wrong, 50U);
  EXPECT_EQ(floor_of(rig(), truth(), plane_with(50, kDepth_mm - 1)).wrong, 0U);
}

TEST(PlainFloor, one_percent_of_coverage_may_be_missing_and_three_beside_edges) {
  const auto less = [](int pixels, bool edges) {
    return beside_plain(rig(), truth(edges), plane_with(pixels, kNone), plane()).holds();
  };
  EXPECT_TRUE(less(90, false));
  EXPECT_FALSE(less(110, false));
  EXPECT_TRUE(less(290, true));
  EXPECT_FALSE(less(310, true));
}

TEST(PlainFloor, nothing_more_may_be_wrong) {
  const auto b = beside_plain(rig(), truth(), plane_with(6, kFringeOff_mm), plane_with(5, kFringeOff_mm));
  EXPECT_TRUE(b.covers_as_much());
  EXPECT_FALSE(b.holds());
  EXPECT_TRUE(beside_plain(rig(), truth(), plane_with(5, kFringeOff_mm), plane_with(5, kFringeOff_mm)).holds());
}

TEST(PlainFloor, map_that_is_wrong_itself_or_empty_is_no_floor) {
  const Map<float> nothing = plane_with(kWidth * kHeight, kNone);
  EXPECT_FALSE(beside_plain(rig(), truth(), nothing, plane_with(10, kFringeOff_mm)).holds());
  EXPECT_FALSE(beside_plain(rig(), truth(), nothing, plane_with(11, kFringeOff_mm)).is_floor());
  EXPECT_FALSE(beside_plain(rig(), truth(), plane(), nothing).is_floor());
}

TEST(PlainFloor, edges_lie_on_both_sides_of_a_jump_and_around_a_hole) {
  Map<float> step = plane();
  for (int v = 0; v < kHeight; ++v)
    for (int u = 50; u < kWidth; ++u) step(u, v) += 2 * kDepthEdge_mm;
  step(10, 10) = kNone;
  const Map<std::uint8_t> edge = depth_edges(step);
  std::size_t marked = 0;
  for (const std::uint8_t e : edge.pixels()) marked += e;
  EXPECT_EQ(marked, 2U * kHeight + 5U);
  EXPECT_EQ(edge(49, 20), 1);
  EXPECT_EQ(edge(50, 20), 1);
}

}  // namespace
}  // namespace enamel::test
