// One wrong bit anywhere in an image: in the manifest refused before the first erase, in the payload before its chunk
// reaches the flash.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "firmware/boot/transitions.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/image_receiver.hpp"
#include "protocol/base/rng.hpp"
#include "protocol/image/dfu_suffix.hpp"
#include "protocol/image/image_file.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::fw {
namespace {

using image::Refusal;

class Flip : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::byte> make(std::size_t payload) const {
    std::vector<std::byte> file =
        test::build(test::plain_description(), test::random_payload(payload, 5), {&keys_.signer(0), 1});
    file.resize(file.size() - image::kSuffixSize);
    return file;
  }
  /// Flips a random bit of the payload; its chunk.
  std::uint32_t flip(std::span<std::byte> payload) {
    const std::size_t at = rng_.below(static_cast<std::uint32_t>(payload.size()));
    payload[at] ^= static_cast<std::byte>(1U << rng_.below(8));
    return static_cast<std::uint32_t>(at / image::kChunkSize);
  }

  test::KeyRing keys_;
  Rng rng_{6, 0, 0};
};

TEST_F(Flip, every_bit_of_the_manifest_is_refused_before_the_first_erase) {
  const image::Signer both[] = {keys_.signer(0), keys_.signer(1)};
  std::vector<std::byte> file = test::build(test::plain_description(), test::random_payload(1000, 5), both);
  const std::size_t length = image::parse_manifest(file)->manifest_len;
  const std::span<const std::byte> manifest = std::span(file).first(length);
  FlashModel flash(flash_map::kSize);
  const auto receiver = std::make_unique<ImageReceiver>(
      boot_regions(flash), UpdateIdentity{test::test_hardware(), keys_.trust(), 0, image::ImageVersion{1, 0, 0, 0}});
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * length; ++bit) {
    const auto mask = static_cast<std::byte>(1U << (bit % 8));
    file[bit / 8] ^= mask;
    receiver->restart(false);
    refused += receiver->take(manifest) ? 0 : 1;
    file[bit / 8] ^= mask;
    // A flip that makes the manifest longer is refused when the rest has come.
    if (refused <= static_cast<int>(bit))
      refused += receiver->take(std::vector<std::byte>(image::kMaxManifest)) ? 0 : 1;
    ASSERT_EQ(refused, static_cast<int>(bit) + 1) << "bit " << bit;
  }
  EXPECT_EQ(flash.operations(), 0U);
  RecordProperty("refused", refused);
  receiver->restart(false);
  EXPECT_TRUE(receiver->take(manifest).has_value()) << "control: the unaltered one is refused too";
  EXPECT_GT(flash.operations(), 0U);
}

TEST_F(Flip, ten_thousand_of_a_whole_image_are_seen_by_their_chunk) {
  std::vector<std::byte> file = make(16U << 20U);
  const auto manifest = image::parse_manifest(file);
  ASSERT_TRUE(manifest.has_value());
  const std::span<std::byte> payload = std::span(file).subspan(manifest->manifest_len);
  int refused = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::size_t at = rng_.below(static_cast<std::uint32_t>(payload.size()));
    const auto mask = static_cast<std::byte>(1U << rng_.below(8));
    const auto chunk = static_cast<std::uint32_t>(at / image::kChunkSize);
    const auto bytes = payload.subspan(std::size_t{chunk} * image::kChunkSize, manifest->chunk_length(chunk));
    payload[at] ^= mask;
    refused += sha256(bytes) == manifest->chunk_digest(chunk) ? 0 : 1;
    payload[at] ^= mask;
  }
  EXPECT_EQ(refused, 10'000);
  for (std::uint32_t chunk = 0; chunk < manifest->chunk_count; ++chunk) {
    const auto bytes = payload.subspan(std::size_t{chunk} * image::kChunkSize, manifest->chunk_length(chunk));
    ASSERT_EQ(sha256(bytes), manifest->chunk_digest(chunk)) << "control: the unaltered image is refused too";
  }
  RecordProperty("refused", refused);
}

TEST_F(Flip, payloads_are_refused_by_the_probe_before_their_chunk_is_written) {
  constexpr std::size_t kPayload = 5 * image::kChunkSize + 333;
  const std::vector<std::byte> good = make(kPayload);
  const std::uint32_t manifest_len = image::parse_manifest(good)->manifest_len;
  constexpr int kFlips = 300;
  RecordProperty("flips", kFlips);
  const FlashModel empty(flash_map::kSize);
  for (int i = 0; i < kFlips; ++i) {
    FlashModel flash = empty;
    const BootRegions regions = boot_regions(flash);
    const auto receiver = std::make_unique<ImageReceiver>(
        regions, UpdateIdentity{test::test_hardware(), keys_.trust(), 0, image::ImageVersion{1, 0, 0, 0}});
    std::vector<std::byte> file = good;
    const std::uint32_t chunk = flip(std::span(file).subspan(manifest_len));
    receiver->restart(false);
    ASSERT_EQ(receiver->take(file).error(), Refusal::kChunkHash);
    ASSERT_EQ(receiver->chunks_done(), chunk);
    ASSERT_EQ(receiver->finish().error(), Refusal::kChunkHash);
    const std::uint64_t place =
        flash_map::kSlot + flash_map::kSlotSize + flash_map::kManifestArea + std::uint64_t{chunk} * kEraseBlock;
    ASSERT_EQ(flash.versions(place, kEraseBlock), empty.versions(place, kEraseBlock)) << "its chunk was touched";
    ASSERT_EQ(ControlStore(regions.control).load()->slot[1].state, SlotState::kWriting);
    // The right bytes are welcome at once.
    receiver->restart(false);
    ASSERT_TRUE(receiver->take(good).has_value());
    ASSERT_EQ(receiver->chunks_written(), 6U - chunk);
  }
}

}  // namespace
}  // namespace enamel::fw
