// Gathering still poses from sweeps through the pattern sets, and what is missing.
#include <gtest/gtest.h>

#include "calib/guide/coverage.hpp"
#include "calib/guide/pose_gatherer.hpp"
#include "protocol/base/rng.hpp"
#include "tests/unit/calib/rig_text.hpp"

namespace enamel::test {
namespace {

using calib::GatherEvent;

constexpr int kWidth = 64, kHeight = 48;
const calib::PixelNoise kNoise{0.1, 0.025};

Rng g_rng(11, 0, 0);

/// Bright squares at a place, with the sensor's noise.
Map<float> picture(double level, int shift_px) {
  Map<float> image(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double signal = ((u + shift_px) / 8 + v / 8) % 2 == 0 ? level : 0.2 * level;
      image(u, v) = static_cast<float>(signal + std::sqrt(kNoise.variance(signal)) * g_rng.normal());
    }
  }
  return image;
}

/// One sweep with the target at `shift_px`; the event of its last set.
GatherEvent sweep(calib::PoseGatherer& gatherer, int shift_px) {
  GatherEvent last = GatherEvent::kNothing;
  for (int set = 0; set < 3; ++set) {
    last = gatherer.add(set, {picture(100, shift_px), picture(set == 0 ? 5 : 100, shift_px), picture(100, shift_px),
                              picture(set == 0 ? 5 : 100, shift_px)});
  }
  return last;
}

calib::PoseGatherer gatherer_of(int sweeps) { return {calib::MultiSets{.cycles = {1}}, sweeps, kNoise}; }

TEST(PoseGatherer, averages_the_sweeps_of_a_target_at_rest) {
  auto gatherer = gatherer_of(4);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(sweep(gatherer, 0), GatherEvent::kNothing);
  ASSERT_EQ(sweep(gatherer, 0), GatherEvent::kPose);
  const calib::PoseFrames pose = gatherer.take();
  EXPECT_NEAR(static_cast<double>(pose.white(4, 4)), 100, 4);
  EXPECT_NEAR(static_cast<double>(pose.black(4, 4)), 5, 2);
  ASSERT_EQ(pose.along_u.size(), 1U);
  EXPECT_EQ(pose.along_u[0].cycles, 1);
  double squares = 0;
  for (const float p : pose.along_v[0].frames[1].pixels()) {
    const double level = static_cast<double>(p) > 60 ? 100 : 20;
    squares += (static_cast<double>(p) - level) * (static_cast<double>(p) - level) / kNoise.variance(level);
  }
  EXPECT_NEAR(squares / (kWidth * kHeight), 0.25, 0.03);  // variance of a mean of four
}

TEST(PoseGatherer, takes_a_pose_only_once_until_the_target_moves) {
  auto gatherer = gatherer_of(2);
  sweep(gatherer, 0);
  ASSERT_EQ(sweep(gatherer, 0), GatherEvent::kPose);
  static_cast<void>(gatherer.take());
  EXPECT_EQ(sweep(gatherer, 0), GatherEvent::kNothing);
  EXPECT_EQ(sweep(gatherer, 0), GatherEvent::kNothing);
  EXPECT_EQ(sweep(gatherer, 3), GatherEvent::kNothing);  // moved on: the first sweep of the next pose
  EXPECT_EQ(sweep(gatherer, 3), GatherEvent::kPose);
}

TEST(PoseGatherer, motion_between_sweeps_is_told) {
  auto gatherer = gatherer_of(3);
  sweep(gatherer, 0);
  sweep(gatherer, 0);
  EXPECT_EQ(sweep(gatherer, 1), GatherEvent::kMoved);
  EXPECT_EQ(gatherer.sweeps_so_far(), 1);
}

TEST(PoseGatherer, motion_within_a_sweep_is_told) {
  auto gatherer = gatherer_of(3);
  sweep(gatherer, 0);
  sweep(gatherer, 0);
  GatherEvent last = GatherEvent::kNothing;
  for (int set = 0; set < 3; ++set) {  // the white frame still fits, the last fringes do not
    const int shift_px = set == 2 ? 1 : 0;
    last = gatherer.add(set, {picture(100, shift_px), picture(set == 0 ? 5 : 100, shift_px), picture(100, shift_px),
                              picture(set == 0 ? 5 : 100, shift_px)});
  }
  EXPECT_EQ(last, GatherEvent::kMoved);
}

TEST(PoseGatherer, a_lost_burst_drops_its_sweep_alone) {
  auto gatherer = gatherer_of(2);
  sweep(gatherer, 0);
  const std::array<Map<float>, 4> frames{picture(100, 0), picture(100, 0), picture(100, 0), picture(100, 0)};
  gatherer.add(0, frames);
  gatherer.add(2, frames);  // set 1 never came
  EXPECT_EQ(gatherer.broken_sweeps(), 1U);
  EXPECT_EQ(sweep(gatherer, 0), GatherEvent::kPose);
}

TEST(MultiSets, need_a_rig_of_that_mode) {
  const auto scanning = calib::parse_rig(kRigText);
  ASSERT_TRUE(scanning);
  const auto none = calib::multi_sets(*scanning);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kPatternSet);
  for (const auto& [cycles, is_good] :
       {std::pair("[1, 4, 16]", true), std::pair("[4, 16]", false), std::pair("[1, 4, 4]", false),
        std::pair("[]", false), std::pair("[1.5]", false)}) {
    const auto from = kRigText.find("\"patterns\": {"), to = kRigText.find('}', from);
    std::string text = kRigText;
    text.replace(from, to + 1 - from, std::string(R"("patterns": {"mode": "multi", "cycles": )") + cycles + "}");
    const auto rig = calib::parse_rig(text);
    ASSERT_TRUE(rig) << rig.error().message();
    const auto sets = calib::multi_sets(*rig);
    EXPECT_EQ(sets.has_value(), is_good) << cycles;
    if (sets) {
      EXPECT_EQ(sets->count(), 7);
    }
  }
}

calib::SeenPose seen(double depth_mm, double azimuth_deg, double u, double v) {
  calib::SeenPose pose;
  pose.depth_mm = depth_mm;
  pose.tilt_deg = 25;
  pose.azimuth_deg = azimuth_deg;
  for (int y = -3; y <= 3; ++y)
    for (int x = -4; x <= 4; ++x) pose.dots_px.emplace_back(u + 50 * x, v + 50 * y);
  return pose;
}

TEST(Coverage, names_what_is_missing_until_there_is_enough) {
  const auto rig = calib::parse_rig(kRigText);
  ASSERT_TRUE(rig);
  const calib::CoverageWanted wanted{.poses = 6, .per_third = 2, .per_side = 1, .field = 0.9};
  std::vector<calib::SeenPose> poses{seen(43, 0, 300, 200), seen(44, 92, 340, 280), seen(48, 178, 260, 240),
                                     seen(48, -91, 360, 240), seen(53, 10, 320, 240)};
  auto c = calib::coverage_of(poses, *rig, wanted);
  EXPECT_EQ(c.by_depth, (std::array<int, 3>{2, 2, 1}));
  EXPECT_EQ(c.by_side, (std::array<int, 4>{2, 1, 1, 1}));
  ASSERT_EQ(c.missing.size(), 2U);
  EXPECT_NE(c.missing[0].find("far depth"), std::string::npos);
  EXPECT_NE(c.missing[1].find("more poses (5 of 6)"), std::string::npos);
  poses.push_back(seen(54, 100, 320, 240));
  EXPECT_TRUE(calib::coverage_of(poses, *rig, wanted).is_enough());
  for (auto& pose : poses) {
    for (auto& p : pose.dots_px) p.x() = std::min(p.x(), 390.0);
  }
  c = calib::coverage_of(poses, *rig, wanted);
  ASSERT_EQ(c.missing.size(), 1U);
  EXPECT_NE(c.missing[0].find("right of the image"), std::string::npos) << c.missing[0];
}

}  // namespace
}  // namespace enamel::test
