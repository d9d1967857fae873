#include "protocol/types/cdr.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::proto {
namespace {

using test::Random;

template <class T>
class Cdr : public ::testing::Test {};
using Messages = ::testing::Types<Burst, DeviceInfo, Status, Command, CommandReply, Event, TimeSyncReq, TimeSyncRep,
                                  AxesReading, ShedNote>;
TYPED_TEST_SUITE(Cdr, Messages);

TYPED_TEST(Cdr, comes_back_equal) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    TypeParam value;
    test::randomize(random, value);
    const auto bytes = to_cdr(value);
    ASSERT_TRUE(bytes) << bytes.error().message();
    const auto back = from_cdr<TypeParam>(*bytes);
    ASSERT_TRUE(back) << back.error().message();
    EXPECT_EQ(*back, value);
  }
}

TYPED_TEST(Cdr, every_truncation_is_an_error) {
  Random random(2);
  for (int i = 0; i < 10; ++i) {
    TypeParam value;
    test::randomize(random, value);
    const Bytes bytes = *to_cdr(value);
    for (std::size_t n = 0; n < bytes.size(); ++n) {
      const auto back = from_cdr<TypeParam>(ByteView(bytes).first(n));
      ASSERT_FALSE(back) << "kept " << n << " of " << bytes.size();
      ASSERT_EQ(back.error().code, ErrorCode::kMessageInvalid);
    }
  }
}

// A flipped bit may make another valid value; it must then encode again without complaint, and never crash.
TYPED_TEST(Cdr, flipped_bits_give_a_value_or_an_error) {
  Random random(3);
  int errors = 0;
  for (int i = 0; i < 3000; ++i) {
    TypeParam value;
    test::randomize(random, value);
    Bytes bytes = *to_cdr(value);
    for (std::size_t flips = 1 + random.below(4); flips > 0; --flips) {
      bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1U << random.below(8));
    }
    const auto back = from_cdr<TypeParam>(bytes);
    if (back) {
      EXPECT_TRUE(to_cdr(*back));
    } else {
      EXPECT_EQ(back.error().code, ErrorCode::kMessageInvalid);
      ++errors;
    }
  }
  EXPECT_GT(errors, 0);
}

TYPED_TEST(Cdr, garbage_gives_a_value_or_an_error) {
  Random random(4);
  for (int i = 0; i < 3000; ++i) {
    Bytes bytes = random.octets(random.below(400));
    if (bytes.size() >= 4 && i % 2 == 0) {
      const Bytes good = *to_cdr(TypeParam{});
      std::copy_n(good.begin(), 4, bytes.begin());
    }
    const auto back = from_cdr<TypeParam>(bytes);
    if (!back) {
      EXPECT_EQ(back.error().code, ErrorCode::kMessageInvalid);
    }
  }
}

TEST(CdrBounds, too_long_texts_and_sequences_are_refused) {
  EXPECT_TRUE(to_cdr(Event{.text = std::string(200, 'x')}));
  EXPECT_EQ(to_cdr(Event{.text = std::string(201, 'x')}).error().code, ErrorCode::kMessageInvalid);
  EXPECT_EQ(to_cdr(Event{.text = std::string("a\0b", 3)}).error().code, ErrorCode::kMessageInvalid);
  EXPECT_EQ(to_cdr(DeviceInfo{.serial = std::string(33, 'x')}).error().code, ErrorCode::kMessageInvalid);
  EXPECT_TRUE(to_cdr(DeviceInfo{.calibration_blob = Bytes(65536)}));
  EXPECT_EQ(to_cdr(DeviceInfo{.calibration_blob = Bytes(65537)}).error().code, ErrorCode::kMessageInvalid);
  EXPECT_EQ(to_cdr(Burst{.meta = std::vector<FrameMeta>(9)}).error().code, ErrorCode::kMessageInvalid);
}

TEST(CdrBounds, members_of_a_later_minor_version_are_skipped) {
  const Event event{.probe_id = 7, .seq = 8, .t_ns = 9, .code = 10, .severity = Severity::kError, .text = "abc"};
  Bytes bytes = *to_cdr(event);
  bytes.resize(bytes.size() - bytes[3]);
  bytes.insert(bytes.end(), {1, 2, 3, 4, 5, 6, 7, 8});
  bytes[3] = 0;
  bytes[4] = static_cast<std::uint8_t>(bytes.size() - 8);
  EXPECT_EQ(from_cdr<Event>(bytes).value(), event);
}

TEST(CdrBounds, a_state_out_of_range_is_an_error) {
  Bytes bytes = *to_cdr(Status{});
  const std::size_t state = 4 + 4 + 4 + 4 + 8;
  bytes[state] = 10;
  EXPECT_TRUE(from_cdr<Status>(bytes));
  bytes[state] = 11;
  EXPECT_FALSE(from_cdr<Status>(bytes));
}

TEST(CdrBounds, an_angle_that_no_axis_reaches_is_refused_written_and_read) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (auto member : {&AxesReading::rot_cmd_deg, &AxesReading::swing_cmd_deg, &AxesReading::rot_read_deg,
                      &AxesReading::swing_read_deg}) {
    AxesReading reading{.burst_index = 3, .probe_id = 9};
    reading.*member = -kMaxAxisAngle_deg;
    const Bytes good = to_cdr(reading).value();
    EXPECT_EQ(from_cdr<AxesReading>(good).value(), reading);
    for (const double bad : {kMaxAxisAngle_deg * (1 + 1e-15), -400.0, kInf, -kInf}) {
      reading.*member = bad;
      EXPECT_EQ(to_cdr(reading).error().code, ErrorCode::kMessageInvalid) << bad;
      Bytes altered = good;
      const double written = -kMaxAxisAngle_deg;
      std::array<std::uint8_t, sizeof written> from{};
      std::memcpy(from.data(), &written, sizeof written);
      const auto at = std::search(altered.begin(), altered.end(), from.begin(), from.end());
      ASSERT_NE(at, altered.end());
      std::memcpy(&*at, &bad, sizeof bad);
      EXPECT_FALSE(from_cdr<AxesReading>(altered)) << bad;
    }
  }
}

TEST(AxesReadings, are_the_same_by_bits_of_every_member) {
  Random random(8);
  AxesReading reading;
  test::randomize(random, reading);
  AxesReading none;
  EXPECT_EQ(none, AxesReading{}) << "absent in both";
  EXPECT_EQ(reading, AxesReading(reading));
  none.rot_cmd_deg = 0.0;
  AxesReading minus = none;
  minus.rot_cmd_deg = -0.0;
  EXPECT_NE(none, minus);
  AxesReading other = reading;
  other.stop ^= 1U;
  EXPECT_NE(other, reading);
  EXPECT_TRUE(other.has_angles_of(reading));
  other = reading;
  other.session_id ^= 1U;
  EXPECT_NE(other, reading);
}

TEST(Texts, are_clipped_at_a_character) {
  EXPECT_EQ(clip_text("abc", 8), "abc");
  EXPECT_EQ(clip_text("abcdef", 3), "abc");
  EXPECT_EQ(clip_text("ab\xC3\xA9z", 3), "ab");
  EXPECT_EQ(clip_text("\xE2\x82\xAC", 2), "");
}

TEST(Names, cover_every_enumerator) {
  EXPECT_EQ(name_of(ProbeState::kScanning), "SCANNING");
  EXPECT_EQ(name_of(static_cast<ProbeState>(11)), "?");
  EXPECT_EQ(name_of(DropReason::kQueueFull), "queue_full");
  EXPECT_EQ(name_of(Opcode::kSafeOff), "SAFE_OFF");
  EXPECT_EQ(name_of(static_cast<Opcode>(0x7777)), "?");
  EXPECT_EQ(name_of(ReplyStatus::kBadState), "BAD_STATE");
}

}  // namespace
}  // namespace enamel::proto
