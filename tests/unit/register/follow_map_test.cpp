// The map while the scan goes on: the same poses as after it, nothing measured twice, and a model that follows.
#include "pipeline/register/map/follow_map.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "pipeline/register/map/map_measure.hpp"
#include "tests/unit/register/drifting_scan.hpp"

namespace enamel::pipeline {
namespace {

class FollowMap : public ::testing::Test {
 protected:
  /// With the first so many bursts.
  [[nodiscard]] std::optional<std::vector<KeyframeMove>> follow(std::size_t bursts, const std::stop_token& stop = {}) {
    MapInput so_far = scan_.input;
    so_far.bursts.resize(bursts);
    const MapNodeMaker maker(scan_.rig, {}, scan_.config);
    const auto node = [&](std::size_t n) { return std::make_shared<const MapNode>(maker(scan_.patches[n], nullptr)); };
    return follow_map(so_far, node, scan_.rig, {}, scan_.config, stop);
  }
  [[nodiscard]] RefinedMap refine() { return refine_map(scan_.input, scan_.rig, {}, scan_.config); }
  [[nodiscard]] static bool same_bits(const RefinedMap& a, const RefinedMap& b) {
    return std::ranges::equal(a.poses, b.poses, [](const Pose& x, const Pose& y) { return x.matrix() == y.matrix(); });
  }

  DriftingScan scan_;
  EdgeMemo memo_;
};

TEST_F(FollowMap, knows_the_poses_that_the_map_after_the_scan_will_have) {
  const auto moves = follow(DriftingScan::kBursts);
  ASSERT_TRUE(moves);
  const RefinedMap after = refine();
  ASSERT_EQ(moves->size(), after.keyframes);
  for (std::size_t k = 0; k < moves->size(); ++k) {
    EXPECT_EQ((*moves)[k].tracked.matrix(), scan_.input.bursts[k].T_model_cam.matrix());
    EXPECT_LT(((*moves)[k].mapped.matrix() - after.poses[k].matrix()).cwiseAbs().maxCoeff(), 1e-9) << "to rounding";
  }
}

TEST_F(FollowMap, what_it_measured_is_not_measured_again_and_changes_no_bit) {
  const RefinedMap alone = refine();
  scan_.input.memo = &memo_;
  EXPECT_EQ(alone.at_hand, 0U);
  ASSERT_TRUE(follow(9));
  const std::size_t first = memo_.size();
  ASSERT_TRUE(follow(DriftingScan::kBursts));
  EXPECT_GT(memo_.size(), first);
  const RefinedMap after = refine();
  EXPECT_EQ(after.at_hand, memo_.size()) << "all of them";
  EXPECT_EQ(after.edges, alone.edges);
  EXPECT_TRUE(same_bits(after, alone));
  EXPECT_EQ(after.bow->bow, alone.bow->bow);
}

TEST_F(FollowMap, is_not_believed_for_other_starts_or_another_limit_of_soft_tissue) {
  scan_.input.memo = &memo_;
  memo_.measured_with(kNothingSoft);
  ASSERT_TRUE(follow(DriftingScan::kBursts));
  scan_.input.bursts[3].T_model_cam.translation().x() += 1e-12;
  const std::size_t all = memo_.size(), at_hand = refine().at_hand;
  EXPECT_LT(at_hand, all);
  EXPECT_GT(at_hand, all / 2) << "edges of the other keyframes";
  EXPECT_EQ(refine().at_hand, all) << "control: kept by now";
  memo_.measured_with(kNothingSoft);
  EXPECT_EQ(refine().at_hand, all);
  memo_.measured_with(40);
  EXPECT_EQ(refine().at_hand, 0U);
}

TEST_F(FollowMap, control_what_is_at_hand_is_what_counts) {
  scan_.input.memo = &memo_;
  ASSERT_TRUE(follow(DriftingScan::kBursts));
  const RefinedMap right = refine();
  const MapBurst &i = scan_.input.bursts[1], &j = scan_.input.bursts[0];
  const Pose start = j.T_model_cam.inverse() * i.T_model_cam;
  auto wrong = memo_.find({i.id, j.id}, start);
  ASSERT_TRUE(wrong && wrong->edge);
  wrong->edge->T_j_i.translation().y() += 0.01;
  memo_.keep({i.id, j.id}, start, *wrong);
  EXPECT_FALSE(same_bits(refine(), right));
}

TEST_F(FollowMap, says_nothing_of_one_burst_or_where_it_is_stopped) {
  EXPECT_FALSE(follow(1));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(follow(DriftingScan::kBursts, stop.get_token()));
}

TEST_F(FollowMap, bends_what_tracking_built_to_where_it_belongs) {
  const DriftingScan bent(DriftingScan::bent);
  scan_.input.bursts = bent.input.bursts;
  const MapBend bend(*follow(DriftingScan::kBursts), calib::middle_depth_mm(scan_.rig));
  const double before = scan_.worst_mm(DriftingScan::bent);
  const double after = scan_.worst_mm([&](int n) { return bend.carry(DriftingScan::bent(n)); });
  EXPECT_GT(before, 0.05);
  EXPECT_LT(after, 0.2 * before);
}

TEST(MapBend, a_motion_of_all_keyframes_is_that_of_every_point) {
  const Pose motion(Eigen::Translation3d(0.1, -0.2, 0.05) * Eigen::AngleAxisd(0.002, Vec3d(1, 2, 2).normalized()));
  std::vector<KeyframeMove> moves;
  for (int n = 0; n < DriftingScan::kBursts; ++n)
    moves.push_back({DriftingScan::truth(n), motion * DriftingScan::truth(n)});
  const MapBend bend(moves, 48);
  const Vec3d looked_at = DriftingScan::truth(4) * Vec3d(0, 0, 48);
  for (const Vec3d& arm : {Vec3d(0, 0, 0), Vec3d(3, -4, 2), Vec3d(0, 40, 0)}) {  // the last: where no keyframe looks
    const Vec3f p = (looked_at + arm).cast<float>(), beside = p + Vec3f(0.4F, 0.3F, -0.5F);
    const MapBend::Shift shift = bend.around(p);
    EXPECT_LT((p + shift.of(p) - (motion * p.cast<double>()).cast<float>()).norm(), 5e-5F);
    EXPECT_LT((beside + shift.of(beside) - (motion * beside.cast<double>()).cast<float>()).norm(), 5e-5F);
  }
  EXPECT_EQ(MapBend().around({1, 2, 3}).of({1, 2, 4}), Vec3f::Zero()) << "nothing moves";
}

TEST(MapBend, what_two_blocks_share_moves_alike) {
  std::vector<KeyframeMove> moves;  // an arch that is bent by 0.2 mm over its 24 mm
  for (int n = 0; n < DriftingScan::kBursts; ++n) {
    const Pose from = DriftingScan::truth(n);
    const double x = from.translation().x() / 24;
    moves.push_back({from, Pose(Eigen::Translation3d(0, 0.2 * x * x, 0)) * from});
  }
  const MapBend bend(moves, 48);
  const Vec3f border = (DriftingScan::truth(3) * Vec3d(0, 0, 48)).cast<float>(), half(0.4F, 0, 0);
  const Vec3f left = bend.around(border - half).of(border), right = bend.around(border + half).of(border);
  EXPECT_GT(left.norm(), 0.01F);
  EXPECT_LT((left - right).norm(), 1e-3F);
}

}  // namespace
}  // namespace enamel::pipeline
