#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "protocol/base/bytes.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/sha256.hpp"
#include "protocol/base/xml.hpp"

namespace enamel {
namespace {

std::span<const std::byte> bytes_of(std::string_view s) { return std::as_bytes(std::span(s.data(), s.size())); }

/// The definition, bit by bit: what the sliced tables must agree with.
std::uint32_t crc32_slow(std::span<const std::byte> bytes) {
  std::uint32_t c = ~0U;
  for (const std::byte b : bytes) {
    c ^= std::to_integer<std::uint32_t>(b);
    for (int i = 0; i < 8; ++i) c = (c & 1U) != 0 ? c >> 1U ^ 0xEDB88320U : c >> 1U;
  }
  return ~c;
}

TEST(Crc32, gives_the_published_check_value) {
  EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}
TEST(Crc32, agrees_with_the_definition_at_every_length_and_offset) {
  std::vector<std::byte> data(67);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::byte>(i * 37 + 5);
  for (std::size_t from = 0; from < 9; ++from) {
    for (std::size_t n = 0; from + n <= data.size(); ++n) {
      const auto part = std::span(data).subspan(from, n);
      ASSERT_EQ(crc32(part), crc32_slow(part)) << from << " " << n;
    }
  }
}
TEST(Crc32, continues_over_pieces) { EXPECT_EQ(crc32(bytes_of("56789"), crc32(bytes_of("1234"))), 0xCBF43926U); }
TEST(Crc32, notices_a_flipped_bit) { EXPECT_NE(crc32(bytes_of("123456788")), 0xCBF43926U); }

TEST(Sha256, gives_the_published_digests) {
  EXPECT_EQ(sha256_hex({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex(bytes_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}
TEST(Sha256, rolling_hash_can_be_read_between_updates) {
  RollingHash h;
  h.update("ab");
  const std::string between = h.hex();
  h.update("c");
  EXPECT_EQ(between, sha256_hex(bytes_of("ab")));
  EXPECT_EQ(h.hex(), sha256_hex(bytes_of("abc")));
}
TEST(Sha256, values_hash_as_their_bytes) {
  const std::array<float, 2> v = {1.F, -2.F};
  EXPECT_EQ(RollingHash().update_values(std::span<const float>(v)).hex(), sha256_hex(std::as_bytes(std::span(v))));
  EXPECT_NE(RollingHash().update_value(1).hex(), RollingHash().update_value(2).hex());
}

TEST(Bytes, round_trips_every_kind_of_value) {
  ByteWriter w;
  w.put<std::uint8_t>(7);
  w.align(4);
  w.put(0x01020304U);
  w.put<std::int64_t>(-5);
  w.put(2.5F);
  w.put_text("hey");
  ASSERT_TRUE(w.patch(4, 0xAABBCCDDU));
  EXPECT_EQ(std::to_integer<int>(w.bytes()[4]), 0xDD) << "little-endian";
  ByteReader r(w.bytes());
  EXPECT_EQ(r.get<std::uint8_t>(), 7);
  r.align(4);
  EXPECT_EQ(r.get<std::uint32_t>(), 0xAABBCCDDU);
  EXPECT_EQ(r.get<std::int64_t>(), -5);
  EXPECT_EQ(r.get<float>(), 2.5F);
  EXPECT_EQ(r.take_text(3), "hey");
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0U);
}
TEST(Bytes, reading_past_the_end_fails_for_good) {
  const std::array<std::byte, 3> three{std::byte{1}, std::byte{2}, std::byte{3}};
  ByteReader r(three);
  EXPECT_EQ(r.get<std::uint32_t>(), 0U);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(r.get<std::uint8_t>(), 0) << "no half-read after a failure";
  EXPECT_EQ(r.position(), 0U);
}
TEST(Bytes, huge_lengths_do_not_wrap_around) {
  const std::array<std::byte, 4> four{};
  ByteReader r(four);
  r.skip(2);
  EXPECT_TRUE(r.take(std::numeric_limits<std::size_t>::max() - 1).empty());
  EXPECT_FALSE(r.ok());
}
TEST(Bytes, align_past_the_end_fails) {
  const std::array<std::byte, 5> five{};
  ByteReader r(five);
  r.skip(5);
  r.align(8);
  EXPECT_FALSE(r.ok());
}
TEST(Bytes, alignment_counts_from_its_origin) {
  ByteWriter w;
  w.put_text("head");
  w.put<std::uint8_t>(1);
  w.align(8, 4);
  EXPECT_EQ(w.size(), 12U);
}
TEST(Bytes, patch_outside_is_refused) {
  ByteWriter w;
  w.put(1U);
  EXPECT_FALSE(w.patch(1, 2U));
  EXPECT_FALSE(w.patch(5, std::uint8_t{2}));
}

TEST(Xml, escapes_what_would_end_content_or_an_attribute) {
  EXPECT_EQ(xml_escaped(R"(<a b="1">&'µm')"), "&lt;a b=&quot;1&quot;&gt;&amp;'µm'");
  EXPECT_EQ(xml_escaped(""), "");
}

}  // namespace
}  // namespace enamel
