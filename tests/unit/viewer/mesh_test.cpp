// Which blocks go to the GPU and where they are put.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <random>
#include <set>

#include "viewer/scene/mesh_diff.hpp"
#include "viewer/scene/slot_arena.hpp"

namespace enamel::view::test {
namespace {

std::shared_ptr<const BlockMesh> block(std::int32_t x, std::size_t vertices = 10, std::uint64_t epoch = 1) {
  auto mesh = std::make_shared<BlockMesh>();
  mesh->block = {x, 0, 0};
  mesh->epoch = epoch;
  mesh->vertices.assign(vertices, Vec3f::Zero());
  mesh->normals.assign(vertices, Vec3f::UnitZ());
  mesh->quality.assign(vertices, 0.5F);
  mesh->triangles.assign(vertices, {0, 1, 2});
  return mesh;
}

ModelSnapshot snapshot(std::vector<std::shared_ptr<const BlockMesh>> blocks) {
  ModelSnapshot model;
  model.blocks = std::move(blocks);
  return model;
}

constexpr std::size_t kPlenty = std::size_t{1} << 30;

TEST(MeshDiff, sends_only_what_changed) {
  MeshDiff diff;
  const auto a = block(0), b = block(1), c = block(2);
  EXPECT_EQ(diff.plan(snapshot({a, b, c}), kPlenty).upload.size(), 3U);
  EXPECT_TRUE(diff.plan(snapshot({a, b, c}), kPlenty).upload.empty());
  const auto b2 = block(1, 12, 2);
  const UploadPlan plan = diff.plan(snapshot({a, b2, c}), kPlenty);
  ASSERT_EQ(plan.upload.size(), 1U);
  EXPECT_EQ(plan.upload[0], b2);
}

TEST(MeshDiff, names_blocks_that_vanished) {
  MeshDiff diff;
  const auto a = block(0), b = block(1);
  static_cast<void>(diff.plan(snapshot({a, b}), kPlenty));
  const UploadPlan plan = diff.plan(snapshot({b}), kPlenty);
  ASSERT_EQ(plan.remove.size(), 1U);
  EXPECT_EQ(plan.remove[0], (BlockIndex{0, 0, 0}));
  EXPECT_EQ(diff.blocks(), 1U);
  EXPECT_EQ(diff.plan(snapshot({a, b}), kPlenty).upload.size(), 1U);  // and it can come back
}

TEST(MeshDiff, keeps_the_budget_and_finishes_later) {
  MeshDiff diff;
  std::vector<std::shared_ptr<const BlockMesh>> blocks;
  blocks.reserve(20);
  for (std::int32_t x = 0; x < 20; ++x) {
    blocks.push_back(block(x));
  }
  const ModelSnapshot model = snapshot(blocks);
  const std::size_t one = gpu_bytes(*blocks[0]);
  std::set<std::int32_t> sent;
  for (std::size_t frame = 0; frame < 7; ++frame) {
    const UploadPlan plan = diff.plan(model, 3 * one);
    EXPECT_LE(plan.upload.size(), 3U);
    for (const auto& b : plan.upload) {
      sent.insert(b->block[0]);
    }
    EXPECT_EQ(plan.pending, 20 - sent.size());
  }
  EXPECT_EQ(sent.size(), 20U);
}

TEST(MeshDiff, block_larger_than_the_budget_still_goes) {
  MeshDiff diff;
  EXPECT_EQ(diff.plan(snapshot({block(0, 1000)}), 10).upload.size(), 1U);
}

TEST(MeshDiff, endlessly_changing_blocks_do_not_starve_the_others) {
  MeshDiff diff;
  const auto last = block(9);
  const std::size_t one = gpu_bytes(*last);
  bool sent = false;
  for (std::uint64_t frame = 0; frame < 10 && !sent; ++frame) {
    std::vector<std::shared_ptr<const BlockMesh>> blocks;
    blocks.reserve(10);
    for (std::int32_t x = 0; x < 9; ++x) {
      blocks.push_back(block(x, 10, frame));  // new with every frame
    }
    blocks.push_back(last);
    for (const auto& b : diff.plan(snapshot(blocks), 2 * one).upload) {
      sent = sent || b == last;
    }
  }
  EXPECT_TRUE(sent);
}

TEST(MeshDiff, malformed_block_keeps_its_predecessor) {
  MeshDiff diff;
  const auto good = block(0);
  static_cast<void>(diff.plan(snapshot({good}), kPlenty));
  auto bad = std::make_shared<BlockMesh>(*good);
  bad->triangles.push_back({0, 1, 10});
  const UploadPlan plan = diff.plan(snapshot({bad, nullptr}), kPlenty);
  EXPECT_TRUE(plan.upload.empty());
  EXPECT_TRUE(plan.remove.empty());
  EXPECT_FALSE(well_formed(*bad));
  EXPECT_TRUE(well_formed(*good));
}

TEST(SlotArena, hands_out_ranges_that_never_overlap_and_takes_them_back) {
  SlotArena arena(64);
  std::map<std::size_t, std::size_t> live;
  std::mt19937 random(7);
  std::size_t sum = 0;
  for (int step = 0; step < 3000; ++step) {
    if (live.empty() || random() % 5 < 3) {
      const Slot slot = arena.allocate(1 + random() % 90);
      const auto after = live.lower_bound(slot.offset);
      ASSERT_TRUE(after == live.end() || slot.offset + slot.size <= after->first);
      ASSERT_TRUE(after == live.begin() || std::prev(after)->first + std::prev(after)->second <= slot.offset);
      ASSERT_LE(slot.offset + slot.size, arena.capacity());
      live.emplace(slot.offset, slot.size);
      sum += slot.size;
    } else {
      const auto victim = std::next(live.begin(), static_cast<std::ptrdiff_t>(random() % live.size()));
      arena.release({victim->first, victim->second});
      sum -= victim->second;
      live.erase(victim);
    }
    ASSERT_EQ(arena.used(), sum);
    if (!live.empty()) {
      ASSERT_GE(arena.end(), std::prev(live.end())->first + std::prev(live.end())->second);
    }
  }
  for (const auto& [offset, size] : live) {
    arena.release({offset, size});
  }
  EXPECT_EQ(arena.used(), 0U);
  EXPECT_EQ(arena.end(), 0U);  // everything merged into one hole again
  const std::size_t capacity = arena.capacity();
  EXPECT_EQ(arena.allocate(capacity).offset, 0U);
  EXPECT_EQ(arena.capacity(), capacity);
}

}  // namespace
}  // namespace enamel::view::test
