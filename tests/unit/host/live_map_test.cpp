// The map while a scan goes on: bursts go in, bends of the shown model come out, and what was measured stays at hand.
#include "host/session/live_map.hpp"

#include <gtest/gtest.h>

#include "host/session/bent_model.hpp"
#include "protocol/base/clock.hpp"
#include "tests/unit/register/drifting_scan.hpp"

namespace enamel::host {
namespace {

using pipeline::DriftingScan;
using pipeline::MapBend;

/// A drifting scan as the sink hands it on. Patches are known by their width.
class LiveMapTest : public ::testing::Test {
 protected:
  /// The scan's burst n, for the first time or again.
  void note(int n, SegmentId segment = kModelSegment, int round = 0) {
    const int number = n + round * DriftingScan::kBursts;
    const BurstId id{static_cast<std::uint64_t>(number)};
    TrackResult at;
    at.segment = segment;
    ledger_.placed(id, at);
    pipeline::PackedPatch patch;
    patch.width = n;
    map_.note({id, pipeline::time_of(number), DriftingScan::bent(n), segment, store_.keep(std::move(patch)), nullptr},
              ledger_, kNothingSoft);
  }
  [[nodiscard]] std::shared_ptr<const MapBend> next_bend() {
    for (;;) {
      if (auto bend = map_.take_bend()) return *bend;
      clock_.sleep_for(Nanoseconds{1'000'000});
    }
  }
  /// Ends the map.
  [[nodiscard]] bool has_tied(int i, int j) {
    const Pose start = DriftingScan::bent(j).inverse() * DriftingScan::bent(i);
    return map_.finish()
        .find({BurstId{static_cast<std::uint64_t>(i)}, BurstId{static_cast<std::uint64_t>(j)}}, start)
        .has_value();
  }
  [[nodiscard]] static double worst_mm(const MapBend& bend) {
    return DriftingScan::worst_mm([&](int n) { return bend.carry(DriftingScan::bent(n)); });
  }

  SteadyClock clock_;
  DriftingScan scan_{DriftingScan::bent};
  pipeline::PatchStore store_{{}};
  SegmentLedger ledger_;
  PipelineConfig config_;
  LiveMap map_{scan_.rig, config_, [this](const pipeline::StoredPatch& kept) {
                 const int n = store_.load(kept, pipeline::Texture::kDropped).width;
                 return scan_.patches[static_cast<std::size_t>(n)];
               }};
};

TEST_F(LiveMapTest, bends_what_is_shown_and_keeps_what_it_measured) {
  for (int n = 0; n < 8; ++n) note(n);
  const auto first = next_bend();
  for (int n = 8; n < DriftingScan::kBursts; ++n) note(n);
  const auto second = next_bend();
  EXPECT_LT(worst_mm(*second), worst_mm(*first)) << "the way back ties the way there";
  EXPECT_LT(worst_mm(*second), 0.3 * DriftingScan::worst_mm(DriftingScan::bent));
  scan_.input.memo = &map_.finish();
  pipeline::IcpConfig icp = config_.track.icp;
  icp.samples.soft_below = kNothingSoft;
  const auto after = pipeline::refine_map(scan_.input, scan_.rig, icp, config_.map);
  EXPECT_GT(after.at_hand, 0U);
  EXPECT_EQ(after.at_hand, scan_.input.memo->size());
  scan_.input.memo = nullptr;
  const auto alone = pipeline::refine_map(scan_.input, scan_.rig, icp, config_.map);
  for (std::size_t n = 0; n < alone.poses.size(); ++n) EXPECT_EQ(alone.poses[n].matrix(), after.poses[n].matrix());
}

TEST_F(LiveMapTest, bursts_of_a_segment_say_nothing_while_it_stands_apart) {
  for (int n = 0; n < DriftingScan::kBursts; ++n) note(n, n < 8 ? kModelSegment : 1);
  static_cast<void>(next_bend());
  EXPECT_TRUE(has_tied(7, 6));
  EXPECT_FALSE(has_tied(15, 0));
}

TEST_F(LiveMapTest, bursts_of_a_segment_count_once_it_is_joined) {
  for (int n = 0; n < DriftingScan::kBursts; ++n) note(n, n < 8 ? kModelSegment : 1);
  static_cast<void>(next_bend());
  ledger_.joined({.segment = 1, .into = kModelSegment}, std::nullopt);
  for (int n = 0; n < 8; ++n) note(n, kModelSegment, 1);
  static_cast<void>(next_bend());
  EXPECT_TRUE(has_tied(15, 0));
}

std::shared_ptr<const BlockMesh> block(std::int32_t index, const Vec3f& at) {
  auto out = std::make_shared<BlockMesh>();
  out->block = {index, 0, 0};
  out->vertices = {at, at + Vec3f(0.2F, 0, 0), at + Vec3f(0, 0.2F, 0)};
  out->triangles = {{0, 1, 2}};
  return out;
}

std::shared_ptr<const MapBend> bend_by(double mm) {
  const Pose from = DriftingScan::truth(2);
  return std::make_shared<const MapBend>(
      std::vector<pipeline::KeyframeMove>{{from, Pose(Eigen::Translation3d(0, mm, 0)) * from}}, 48);
}

BurstPreview preview_of(std::vector<std::shared_ptr<const BlockMesh>> blocks) {
  BurstPreview out;
  auto model = std::make_shared<ModelSnapshot>();
  model->blocks = std::move(blocks);
  out.model = std::move(model);
  return out;
}

TEST(BentModel, a_block_is_moved_where_it_shows_and_once) {
  BentModel bent;
  const auto a = block(0, {1, 2, 3});
  const auto shown = std::make_shared<const BurstPreview>(preview_of({a}));
  EXPECT_EQ(bent(shown), shown) << "nothing is known yet";
  bent.bend_by(bend_by(0.002));
  EXPECT_EQ(bent(shown)->model->blocks[0], a) << "two microns";
  bent.bend_by(bend_by(0.05));
  const auto moved = bent(shown)->model->blocks[0];
  EXPECT_NEAR(moved->vertices[2].y(), 2.25, 1e-5);
  EXPECT_EQ(moved->triangles, a->triangles);
  EXPECT_NEAR(bent(shown)->T_model_cam.translation().y(), 0.05, 1e-6);
  bent.bend_by(bend_by(0.053));
  EXPECT_EQ(bent(shown)->model->blocks[0], moved) << "three microns more";
  bent.bend_by(bend_by(0.06));
  EXPECT_NEAR(bent(shown)->model->blocks[0]->vertices[2].y(), 2.26, 1e-5);
  bent.bend_by(bend_by(0));
  EXPECT_EQ(bent(shown)->model->blocks[0], a);
  bent.bend_by(bend_by(0.05));
  const auto b = block(0, {1, 2.1F, 3});
  EXPECT_NEAR(bent(std::make_shared<const BurstPreview>(preview_of({b})))->model->blocks[0]->vertices[0].y(), 2.15,
              1e-5)
      << "fused on in the meantime";
}

TEST(BentModel, a_segment_apart_stays_and_the_model_beside_it_moves) {
  BentModel bent;
  bent.bend_by(bend_by(0.05));
  BurstPreview apart = preview_of({block(0, {1, 2, 3})});
  apart.segment = 1;
  apart.whole = preview_of({block(0, {4, 5, 6})}).model;
  const auto out = bent(std::make_shared<const BurstPreview>(apart));
  EXPECT_EQ(out->model, apart.model);
  EXPECT_EQ(out->T_model_cam.matrix(), apart.T_model_cam.matrix());
  EXPECT_NEAR(out->whole->blocks[0]->vertices[0].y(), 5.05, 1e-5);
  EXPECT_NEAR(out->T_model_return.translation().y(), 0.05, 1e-6);
}

}  // namespace
}  // namespace enamel::host
