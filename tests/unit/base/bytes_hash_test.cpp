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

TEST(Crc32, GivesThePublishedCheckValue) {
  EXPECT_EQ(crc32(bytes_of("123456789")), 0xCBF43926U);
  EXPECT_EQ(crc32({}), 0U);
}
TEST(Crc32, AgreesWithTheDefinitionAtEveryLengthAndOffset) {
  std::vector<std::byte> data(67);
  for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::byte>(i * 37 + 5);
  for (std::size_t from = 0; from < 9; ++from) {
    for (std::size_t n = 0; from + n <= data.size(); ++n) {
      const auto part = std::span(data).subspan(from, n);
      ASSERT_EQ(crc32(part), crc32_slow(part)) << from << " " << n;
    }
  }
}
TEST(Crc32, ContinuesOverPieces) { EXPECT_EQ(crc32(bytes_of("56789"), crc32(bytes_of("1234"))), 0xCBF43926U); }
TEST(Crc32, NoticesAFlippedBit) { EXPECT_NE(crc32(bytes_of("123456788")), 0xCBF43926U); }

TEST(Sha256, GivesThePublishedDigests) {
  EXPECT_EQ(sha256_hex({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex(bytes_of("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}
TEST(Sha256, RollingHashCanBeReadBetweenUpdates) {
  RollingHash h;
  h.update("ab");
  const std::string between = h.hex();
  h.update("c");
  EXPECT_EQ(between, sha256_hex(bytes_of("ab")));
  EXPECT_EQ(h.hex(), sha256_hex(bytes_of("abc")));
}
TEST(Sha256, ValuesHashAsTheirBytes) {
  const std::array<float, 2> v = {1.F, -2.F};
  EXPECT_EQ(RollingHash().update_values(std::span<const float>(v)).hex(), sha256_hex(std::as_bytes(std::span(v))));
  EXPECT_NE(RollingHash().update_value(1).hex(), RollingHash().update_value(2).hex());
}

TEST(Bytes, RoundTripsEveryKindOfValue) {
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
TEST(Bytes, ReadingPastTheEndFailsForGood) {
  const std::array<std::byte, 3> three{std::byte{1}, std::byte{2}, std::byte{3}};
  ByteReader r(three);
  EXPECT_EQ(r.get<std::uint32_t>(), 0U);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(r.get<std::uint8_t>(), 0) << "no half-read after a failure";
  EXPECT_EQ(r.position(), 0U);
}
TEST(Bytes, HugeLengthsDoNotWrapAround) {
  const std::array<std::byte, 4> four{};
  ByteReader r(four);
  r.skip(2);
  EXPECT_TRUE(r.take(std::numeric_limits<std::size_t>::max() - 1).empty());
  EXPECT_FALSE(r.ok());
}
TEST(Bytes, AlignPastTheEndFails) {
  const std::array<std::byte, 5> five{};
  ByteReader r(five);
  r.skip(5);
  r.align(8);
  EXPECT_FALSE(r.ok());
}
TEST(Bytes, AlignmentCountsFromItsOrigin) {
  ByteWriter w;
  w.put_text("head");
  w.put<std::uint8_t>(1);
  w.align(8, 4);
  EXPECT_EQ(w.size(), 12U);
}
TEST(Bytes, PatchOutsideIsRefused) {
  ByteWriter w;
  w.put(1U);
  EXPECT_FALSE(w.patch(1, 2U));
  EXPECT_FALSE(w.patch(5, std::uint8_t{2}));
}

TEST(Xml, EscapesWhatWouldEndContentOrAnAttribute) {
  EXPECT_EQ(xml_escaped(R"(<a b="1">&'µm')"), "&lt;a b=&quot;1&quot;&gt;&amp;'µm'");
  EXPECT_EQ(xml_escaped(""), "");
}

}  // namespace
}  // namespace enamel
