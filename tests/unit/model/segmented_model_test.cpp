// Segments apart from the model: fused for themselves, taken over as soon as they are joined, to the same surface.
#include "pipeline/model/segments/segmented_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/model/rig.hpp"
#include "pipeline/decode/triangulate/ray_depth.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

namespace sy = ::enamel::synthetic;

class SegmentedModelTest : public ::testing::Test {
 protected:
  SegmentedModelTest() { rays_ = std::make_shared<const RayDepth>(RayDepth::bake(rig_, *rig_.depth_range).value()); }
  [[nodiscard]] SegmentedModel make() const { return {rig_, {}, Unpacker(rays_, {}), keep_history_, store_}; }
  [[nodiscard]] static Pose pose(int n) {
    return sy::looking_at(Vec3d(0.3 * n, 0.1 * n, 0), Vec3d(0.02 * n, 0, 1), 48);
  }
  [[nodiscard]] SurfacePatch patch(int n) const {
    SurfacePatch made = sy::render(rig_, sy::sphere(Vec3d(0, 0, 30), 30), pose(n));
    made.texture_dn = Map<float>(rig_.camera.width, rig_.camera.height, 80.25F);
    return made;
  }
  void feed(SegmentedModel& model, int n, SegmentId segment, const Pose& T, std::vector<SegmentJoin> joins = {}) {
    TrackResult placed;
    placed.state = TrackState::kTracking;
    placed.segment = segment;
    placed.T_model_cam = T;
    placed.joins = std::move(joins);
    (void)model.integrate(BurstId{static_cast<std::uint64_t>(n)}, patch(n), placed);
  }
  bool keep_history_ = false;
  PatchStoreConfig store_;
  calib::Rig rig_ = calib::load_rig(ENAMEL_SOURCE_DIR "/config/rigs/probe.json").value();
  std::shared_ptr<const RayDepth> rays_;
};

/// Sum over all voxels of a grid: tells models apart.
double content(const TsdfModel& model) {
  double sum = 0;
  for (std::size_t b = 0; b < model.grid().size(); ++b) {
    const Block& block = model.grid().block(static_cast<std::int32_t>(b));
    for (std::size_t v = 0; v < block.bursts.size(); ++v) sum += static_cast<double>(block.bursts[v]);
  }
  return sum;
}

TEST_F(SegmentedModelTest, a_packed_patch_keeps_depth_to_a_fraction_of_its_sigma) {
  SurfacePatch original = patch(1);
  original.depth_mm(3, 3) = std::nanf("");
  const PackedPatch packed = pack(original, Texture::kKept);
  const SurfacePatch again = Unpacker(rays_, {})(packed);
  for (std::size_t i = 0; i < original.depth_mm.size(); ++i) {
    ASSERT_EQ(std::isnan(original.depth_mm[i]), std::isnan(again.depth_mm[i])) << i;
    if (std::isnan(original.depth_mm[i])) continue;
    ASSERT_NEAR(original.depth_mm[i], again.depth_mm[i], 2e-4F);
    ASSERT_NEAR(original.sigma_mm[i], again.sigma_mm[i], 0.025F * original.sigma_mm[i]);
    ASSERT_LT((original.points[i] - again.points[i]).norm(), 1e-3F);
    if (!std::isfinite(again.normals[i].x())) continue;
    ASSERT_GT(original.normals[i].dot(again.normals[i]), 0.99F);
  }
  EXPECT_EQ(again.texture_dn[0], 80.25F);
  EXPECT_LT(packed.bytes(), original.depth_mm.size() * 6) << "the maps have forty a pixel";
}

TEST_F(SegmentedModelTest, what_is_apart_does_not_touch_the_model) {
  SegmentedModel model = make();
  feed(model, 0, 0, pose(0));
  const double before = content(model.model());
  feed(model, 1, 1, Pose::Identity());
  EXPECT_EQ(content(model.model()), before);
  ASSERT_NE(model.apart(), nullptr);
  EXPECT_GT(content(*model.apart()), 0);
  EXPECT_EQ(model.view(Pose::Identity(), patch(1)).segment, 1U);
  EXPECT_FALSE(model.view(Pose::Identity(), patch(1)).empty);
}

TEST_F(SegmentedModelTest, a_joined_segment_becomes_part_of_the_model_a_few_bursts_at_a_time) {
  SegmentedModel model = make(), straight = make();
  feed(model, 0, 0, pose(0));
  const Pose T_model_segment = pose(1);  // its first burst defines the segment's frame
  for (int n = 1; n < 5; ++n) feed(model, n, 1, T_model_segment.inverse() * pose(n));
  feed(model, 5, 0, pose(5), {{1, 0, T_model_segment}});
  EXPECT_TRUE(model.kept().empty());
  EXPECT_EQ(model.apart(), nullptr);
  const double before = content(model.model());
  model.catch_up(2);
  const double half = content(model.model());
  EXPECT_GT(half, before);
  model.catch_up(100);
  EXPECT_GT(content(model.model()), half);
  for (const int n : {0, 5}) feed(straight, n, 0, pose(n));
  for (int n = 1; n < 5; ++n) {
    const SurfacePatch kept = Unpacker(rays_, {})(pack(patch(n), Texture::kDropped));
    (void)straight.model().integrate(BurstId{static_cast<std::uint64_t>(n)}, kept, pose(n));
  }
  EXPECT_NEAR(content(model.model()), content(straight.model()), 1e-4 * content(straight.model()))
      << "as if it had stood there from the beginning";
}

TEST_F(SegmentedModelTest, segments_apart_can_be_joined_to_each_other_first) {
  SegmentedModel model = make();
  feed(model, 0, 0, pose(0));
  for (int n = 1; n < 3; ++n) feed(model, n, 1, pose(n));
  for (int n = 3; n < 5; ++n) feed(model, n, 2, Pose::Identity());
  const Pose T12 = pose(3);
  model.join({2, 1, T12});
  ASSERT_EQ(model.kept().size(), 1U);
  ASSERT_EQ(model.kept().at(1).size(), 4U);
  EXPECT_TRUE(model.kept().at(1)[3].T_segment_cam.isApprox(T12));
  EXPECT_GT(content(model.fuse_apart(1)), 0);
  model.join({1, 0, Pose::Identity()});
  EXPECT_TRUE(model.kept().empty());
}

TEST_F(SegmentedModelTest, the_model_can_be_fused_anew_from_its_history) {
  keep_history_ = true;
  SegmentedModel model = make();
  feed(model, 0, 0, pose(0));
  for (int n = 1; n < 3; ++n) feed(model, n, 1, pose(1).inverse() * pose(n));
  feed(model, 3, 0, pose(3), {{1, 0, pose(1)}});
  const std::vector<KeptBurst> history = model.take_history();
  ASSERT_EQ(history.size(), 4U) << "those that wait to be taken over too";
  for (int n = 0; n < 4; ++n) {
    const KeptBurst& kept = history[static_cast<std::size_t>(n)];
    EXPECT_EQ(kept.id.value, static_cast<std::uint64_t>(n));
    EXPECT_TRUE(kept.T_segment_cam.isApprox(pose(n)));
    EXPECT_TRUE(model.patch_of(kept, Texture::kDropped).texture_dn.empty());
  }
  model.rebuild(history, [&](std::size_t n) { return model.patch_of(history[n], Texture::kDropped); });
  SegmentedModel straight = make();
  for (int n = 0; n < 4; ++n) feed(straight, n, 0, pose(n));
  EXPECT_NEAR(content(model.model()), content(straight.model()), 0.01 * content(straight.model()));
  EXPECT_TRUE(model.take_history().empty());
}

TEST_F(SegmentedModelTest, is_the_same_whether_bursts_are_kept_in_memory_or_in_a_file) {
  keep_history_ = true;
  const auto scan = [&](SegmentedModel& model) {
    feed(model, 0, 0, pose(0));
    for (int n = 1; n < 4; ++n) feed(model, n, 1, pose(1).inverse() * pose(n));
    feed(model, 4, 0, pose(4), {{1, 0, pose(1)}});
    model.catch_up(2);
    const auto history = model.take_history();
    model.rebuild(history, [&](std::size_t n) { return model.patch_of(history[n], Texture::kDropped); });
    return content(model.model());
  };
  SegmentedModel memory = make();
  store_ = {.folder = ::testing::TempDir(), .memory_bytes = 0};
  SegmentedModel file = make();
  EXPECT_EQ(scan(memory), scan(file));
  EXPECT_EQ(memory.stored().in_file, 0U);
  EXPECT_EQ(file.stored().in_file, 5U);
}

}  // namespace
}  // namespace enamel::pipeline
