#include "host/session/model_checkpoint.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "protocol/base/clock.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/rng.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel::host {
namespace {

using std::chrono::milliseconds;

std::shared_ptr<const BlockMesh> drawn_block(Rng& rng, std::int32_t at) {
  auto block = std::make_shared<BlockMesh>();
  block->block = {at, -at, 3};
  block->epoch = rng.below(1000);
  const auto vertices = static_cast<std::uint32_t>(3 + rng.below(40));
  for (std::uint32_t v = 0; v < vertices; ++v) {
    block->vertices.emplace_back(Vec3f::Random());
    block->normals.emplace_back(Vec3f::Random().normalized());
    block->quality.push_back(static_cast<float>(rng.uniform()));
  }
  for (std::uint32_t t = 0; t + 2 < vertices; ++t) block->triangles.push_back({t, t + 1, t + 2});
  for (std::uint32_t v = 0; at % 2 == 0 && v < vertices; ++v)
    block->soft.push_back(static_cast<std::uint8_t>(rng.below(2)));
  return block;
}

BurstPreview drawn_preview(Rng& rng, int blocks) {
  auto model = std::make_shared<ModelSnapshot>();
  model->after_burst = rng.below(1000);
  for (int n = 0; n < blocks; ++n) model->blocks.push_back(drawn_block(rng, n));
  BurstPreview out;
  out.model = model;
  out.T_model_cam.translation() = Vec3d(1, 2, 3) * rng.uniform();
  return out;
}

std::string bytes_of(const BurstPreview& shown) { return checkpoint_bytes({shown.model, shown.T_model_cam}); }

/// With the sum that belongs to it: what remains is for the reader to notice.
std::string summed(std::string body) {
  const std::uint32_t sum = crc32(std::as_bytes(std::span(body)));
  return body.append(reinterpret_cast<const char*>(&sum), sizeof sum);
}

TEST(ModelCheckpoint, comes_back_as_it_was) {
  Rng rng(5, 0, 0);
  for (const int blocks : {0, 1, 7}) {
    const BurstPreview shown = drawn_preview(rng, blocks);
    const auto back = parse_checkpoint(bytes_of(shown));
    ASSERT_TRUE(back) << back.error().detail;
    EXPECT_EQ(back->T_model_cam.matrix(), shown.T_model_cam.matrix());
    EXPECT_EQ(bytes_of(*as_preview(*back)), bytes_of(shown));
    EXPECT_FALSE(as_preview(*back)->placed) << "where the probe is now nobody knows";
  }
}

TEST(ModelCheckpoint, damage_is_refused_wherever_it_lies) {
  Rng rng(6, 0, 0);
  const std::string whole = bytes_of(drawn_preview(rng, 3));
  for (int n = 0; n < 2000; ++n) {
    std::string flipped = whole;
    flipped[rng.below(static_cast<std::uint32_t>(whole.size()))] ^= static_cast<char>(1U << rng.below(8));
    EXPECT_FALSE(parse_checkpoint(flipped));
    EXPECT_FALSE(parse_checkpoint(whole.substr(0, rng.below(static_cast<std::uint32_t>(whole.size())))));
  }
}

TEST(ModelCheckpoint, counts_and_indices_are_not_believed_because_the_sum_is_right) {
  Rng rng(7, 0, 0);
  const std::string whole = bytes_of(drawn_preview(rng, 2));
  const std::string body = whole.substr(0, whole.size() - 4);
  ASSERT_TRUE(parse_checkpoint(summed(body)));
  EXPECT_FALSE(parse_checkpoint(summed(body + "x")));
  EXPECT_FALSE(parse_checkpoint(summed(body.substr(0, body.size() - 12))));
  std::string far_corner = body;  // of the last triangle; behind it stands that none is soft
  far_corner[body.size() - 2] = '\x7f';
  EXPECT_FALSE(parse_checkpoint(summed(far_corner)));
  std::string soft = body;
  soft[body.size() - 1] = 1;
  EXPECT_FALSE(parse_checkpoint(summed(soft)));
  for (std::size_t at = 20 + 128 + 8; at < 20 + 128 + 8 + 40; ++at) {  // counts: blocks, vertices, triangles
    std::string many = body;
    many[at] = '\xff';
    (void)!parse_checkpoint(summed(many));  // whatever it is, no crash and no memory without end
  }
}

TEST(ModelCheckpoint, a_model_has_one_text_and_another_flag_is_none_of_it) {
  Rng rng(9, 0, 0);
  const BurstPreview shown = drawn_preview(rng, 1);  // its one block has soft vertices
  const std::string whole = bytes_of(shown);
  std::string body = whole.substr(0, whole.size() - 4);
  char& has_soft = body[body.size() - shown.model->blocks.front()->soft.size() - 1];
  ASSERT_EQ(has_soft, 1);
  EXPECT_TRUE(parse_checkpoint(summed(body)));
  for (const int flag : {0, 2, 255}) {
    has_soft = static_cast<char>(flag);
    EXPECT_FALSE(parse_checkpoint(summed(body))) << flag;
  }
  auto model = std::make_shared<ModelSnapshot>();
  model->blocks = {std::make_shared<BlockMesh>()};
  std::string nothing = checkpoint_bytes({model, Pose::Identity()});
  nothing.resize(nothing.size() - 4);
  ASSERT_TRUE(parse_checkpoint(summed(nothing)));
  nothing.back() = 1;
  EXPECT_FALSE(parse_checkpoint(summed(nothing))) << "soft, and no vertex";
}

bool appears(const std::string& path) {
  SteadyClock clock;
  for (int n = 0; n < 400 && !std::filesystem::exists(path); ++n) clock.sleep_for(milliseconds(10));
  return std::filesystem::exists(path);
}

TEST(ModelCheckpoint, the_writer_keeps_the_model_and_nothing_of_a_segment_apart) {
  const test::TempFolder tmp;
  Rng rng(8, 0, 0);
  const std::string path = checkpoint_path(tmp / "");
  CheckpointWriter writer(path, milliseconds(5));
  BurstPreview apart = drawn_preview(rng, 2);
  apart.segment = 3;
  writer.offer(apart);
  writer.offer(BurstPreview{});
  SteadyClock().sleep_for(milliseconds(50));
  EXPECT_FALSE(std::filesystem::exists(path));
  const BurstPreview shown = drawn_preview(rng, 2);
  writer.offer(shown);
  ASSERT_TRUE(appears(path));
  EXPECT_EQ(read_file(path).value_or(""), bytes_of(shown));
}

}  // namespace
}  // namespace enamel::host
