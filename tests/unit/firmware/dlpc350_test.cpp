// The bench projector's driver against a MODEL of its controller, byte by byte against a table that is written out
// here.
#include "firmware/device/linux/dlpc350/dlpc350.hpp"

#include <gmock/gmock.h>

#include <set>

#include "tests/unit/firmware/dlpc350_model.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = Dlpc350Model::Bytes;

/// Every message from the opening to the light, 16-bit words little endian: flags, number, length, CMD3, CMD2, payload.
const std::vector<Bytes> kOpened{
    {0x40, 1, 3, 0, 0x07, 0x1A, 0x00},              // all LEDs off, by hand
    {0x40, 2, 3, 0, 0x24, 0x1A, 0x00},              // stop
    {0xC0, 3, 2, 0, 0x0A, 0x1A},                    // hardware status?
    {0x40, 4, 3, 0, 0x05, 0x1A, 0x00},              // normal polarity
    {0xC0, 5, 2, 0, 0x05, 0x1A},                    // polarity?
    {0x40, 6, 5, 0, 0x01, 0x0B, 0xFF, 0xFF, 0xFF},  // no current
    {0xC0, 7, 2, 0, 0x01, 0x0B},                    // current?
};
const std::vector<Bytes> kArmed{
    {0x40, 8, 3, 0, 0x24, 0x1A, 0x00},                                              // stop
    {0x40, 9, 3, 0, 0x1B, 0x1A, 0x01},                                              // patterns
    {0xC0, 10, 2, 0, 0x1B, 0x1A},                                                   // mode?
    {0x40, 11, 3, 0, 0x22, 0x1A, 0x03},                                             // out of flash
    {0x40, 12, 3, 0, 0x23, 0x1A, 0x01},                                             // triggered
    {0x40, 13, 5, 0, 0x1D, 0x1A, 0x00, 0xBB, 0xBB},                                 // TRIG_OUT_1: high, 0 us, 0 us
    {0x40, 14, 4, 0, 0x1E, 0x1A, 0x00, 0xBB},                                       // TRIG_OUT_2: high, 0 us
    {0x40, 15, 6, 0, 0x35, 0x1A, 0xA5, 0x03, 0x00, 0x00},                           // 933 x 107.2 ns = 100 us
    {0x40, 16, 6, 0, 0x31, 0x1A, 0x03, 0x01, 0x03, 0x01},                           // 4 entries, forever, 4, 2 images
    {0x40, 17, 10, 0, 0x29, 0x1A, 0x8D, 0x20, 0x00, 0x00, 0x73, 0x21, 0x00, 0x00},  // 8333 us, 8563 us
    {0x40, 18, 3, 0, 0x33, 0x1A, 0x02},                                             // table
    {0x40, 19, 3, 0, 0x32, 0x1A, 0x00},                                             // from 0
    {0x40, 20, 14, 0, 0x34, 0x1A, 0x01, 0x48, 0x06, 0x05, 0x48, 0x02,               // green, swap; red
     0x09, 0x48, 0x02, 0x01, 0x48, 0x06},                                           // blue; green, swap
    {0x40, 21, 3, 0, 0x33, 0x1A, 0x00},                                             // closed
    {0x40, 22, 3, 0, 0x33, 0x1A, 0x01},                                             // images
    {0x40, 23, 3, 0, 0x32, 0x1A, 0x00},                                             // from 0
    {0x40, 24, 4, 0, 0x34, 0x1A, 0x06, 0x05},                                       // 5 and 6, in reverse
    {0x40, 25, 3, 0, 0x33, 0x1A, 0x00},                                             // closed
    {0x40, 26, 3, 0, 0x1A, 0x1A, 0x00},                                             // validate
    {0xC0, 27, 2, 0, 0x1A, 0x1A},                                                   // valid?
};
const std::vector<Bytes> kLit{
    {0x40, 28, 5, 0, 0x01, 0x0B, 0xFF, 0xFF, 0xC3},  // blue 60 of 255
    {0xC0, 29, 2, 0, 0x01, 0x0B},                    // current?
    {0x40, 30, 3, 0, 0x07, 0x1A, 0x08},              // LEDs as the table says
    {0x40, 31, 3, 0, 0x24, 0x1A, 0x02},              // start
    {0xC0, 32, 2, 0, 0x0C, 0x1A},                    // running?
    {0x40, 33, 3, 0, 0x24, 0x1A, 0x00},              // stop
    {0x40, 34, 3, 0, 0x07, 0x1A, 0x00},              // dark
};

std::vector<Bytes> whole_session() {
  std::vector<Bytes> all = kOpened;
  all.insert(all.end(), kArmed.begin(), kArmed.end());
  all.insert(all.end(), kLit.begin(), kLit.end());
  return all;
}

class Projector350 : public testing::Test {
 protected:
  Result<Dlpc350> try_open() { return Dlpc350::open(model, clock, kDlpc350Limits, 5); }
  Dlpc350 open() {
    auto projector = try_open();
    EXPECT_TRUE(projector.has_value()) << projector.error().message();
    return *projector;
  }
  std::string why_not_open() {
    const auto projector = try_open();
    EXPECT_FALSE(projector.has_value());
    EXPECT_EQ(model.leds, 0);
    return projector ? "" : projector.error().detail;
  }
  /// From opening to dark again, as a board does it; ends early where something fails.
  std::vector<Bytes> session() {
    model.polls_until_mode = model.polls_until_valid = model.polls_until_running = 0;
    auto projector = try_open();
    if (projector && projector->arm(kDlpc350Timing) && projector->set_led(60) && projector->start() &&
        projector->stop()) {
      projector->blank();
    }
    return model.messages;
  }
  Dlpc350Model model;
  VirtualClock clock;
};

TEST_F(Projector350, says_byte_by_byte_what_the_table_says) {
  const auto expected = whole_session();
  const auto said = session();
  ASSERT_EQ(said.size(), expected.size());
  for (std::size_t i = 0; i < said.size(); ++i) EXPECT_EQ(said[i], expected[i]) << "message " << i + 1;
  EXPECT_EQ(model.unpadded, 0);
}

/// One wrong bit in any byte of any message is seen by the comparison above.
TEST_F(Projector350, comparison_sees_every_wrong_byte) {
  const auto expected = whole_session();
  for (std::size_t message = 0; message < expected.size(); ++message) {
    for (std::size_t byte = 0; byte < expected[message].size(); ++byte) {
      model = {};
      model.spoiled_message = static_cast<int>(message);
      model.spoiled_byte = byte;
      EXPECT_NE(session(), expected) << message << " byte " << byte;
    }
  }
}

TEST_F(Projector350, shows_nothing_until_it_is_told_to) {
  model.polls_until_mode = 3;
  Dlpc350 projector = open();
  EXPECT_EQ(model.leds, 0);
  EXPECT_FALSE(model.runs);
  EXPECT_THAT(projector.start().error().detail, HasSubstr("arm it first"));
  ASSERT_TRUE(projector.arm(kDlpc350Timing).has_value());
  ASSERT_TRUE(projector.start().has_value());
  EXPECT_EQ(model.leds, 0);
  ASSERT_TRUE(projector.set_led(1).has_value());
  EXPECT_EQ(model.leds, 8);
  projector.blank();
  EXPECT_EQ(model.leds, 0);
}

TEST_F(Projector350, light_never_passes_the_ceiling_that_is_kept_here) {
  Dlpc350 projector = open();
  const auto above = projector.set_led(121);
  ASSERT_FALSE(above.has_value());
  EXPECT_EQ(above.error().code, ErrorCode::kConfigValue);
  EXPECT_THAT(above.error().detail, HasSubstr("at most 120"));
  EXPECT_EQ(model.registers[0x0B01], (Bytes{255, 255, 255}));
  ASSERT_TRUE(projector.set_led(120).has_value());
  EXPECT_EQ(model.registers[0x0B01], (Bytes{255, 255, 135}));
  model.keeps_current = false;
  EXPECT_THAT(projector.set_led(60).error().detail, HasSubstr("does not keep the LED current"));
  EXPECT_EQ(model.leds, 0);
  const auto beyond = Dlpc350::open(model, clock, {.max_led_code = 256}, 0);
  ASSERT_FALSE(beyond.has_value());
  EXPECT_EQ(beyond.error().code, ErrorCode::kConfigValue);
}

TEST_F(Projector350, that_cannot_be_used_is_told_why) {
  model.hardware = 0;
  EXPECT_THAT(why_not_open(), HasSubstr("not initialised after 3.0 s"));
  model = {};
  model.polarity_stuck = true;
  EXPECT_THAT(why_not_open(), HasSubstr("polarity"));
  model = {};
  model.keeps_current = false;
  EXPECT_THAT(why_not_open(), HasSubstr("LED current"));
  model = {};
  Dlpc350 projector = open();
  model.polls_until_mode = 1'000'000;
  EXPECT_THAT(projector.arm(kDlpc350Timing).error().detail, HasSubstr("not in its pattern mode after 1.0 s"));
  model.polls_until_mode = 0;
  model.polls_until_valid = 1'000'000;
  EXPECT_THAT(projector.arm(kDlpc350Timing).error().detail, HasSubstr("still being validated after 1.0 s"));
  model.polls_until_valid = 0;
  ASSERT_TRUE(projector.arm(kDlpc350Timing).has_value());
  ASSERT_TRUE(projector.set_led(60).has_value());
  model.main = 1;  // mirrors parked
  EXPECT_THAT(projector.start().error().detail, HasSubstr("does not run after 2.0 s"));
  EXPECT_EQ(model.leds, 0);
}

TEST_F(Projector350, timing_is_checked_here_and_there) {
  EXPECT_THAT(dlpc350_timing_faults(kDlpc350Timing), testing::IsEmpty());
  EXPECT_THAT(dlpc350_timing_faults({.illum_us = 8333, .post_us = 229}),
              ElementsAre(HasSubstr("black behind a pattern takes 230 us, but post_us is 229")));
  EXPECT_THAT(dlpc350_timing_faults({}), ElementsAre(HasSubstr("8333 us"), HasSubstr("230 us")));
  EXPECT_THAT(dlpc350_timing_faults({.illum_us = 9000, .pre_us = 60'000, .post_us = 230, .bits = 7}),
              ElementsAre(HasSubstr("7 bits"), HasSubstr("56204 us")));
  Dlpc350 projector = open();
  ASSERT_TRUE(projector.set_led(60).has_value());
  const auto armed = projector.arm({});
  ASSERT_FALSE(armed.has_value());
  EXPECT_EQ(armed.error().code, ErrorCode::kBoardTiming);
  EXPECT_EQ(model.leds, 0);
  EXPECT_FALSE(projector.start().has_value());
}

TEST_F(Projector350, each_bit_of_the_validation_has_its_words) {
  std::set<std::string> said;
  for (unsigned bit = 0; bit < 7; ++bit) {
    model = {};
    model.also_invalid = static_cast<std::uint8_t>(1U << bit);
    Dlpc350 projector = open();
    ASSERT_TRUE(projector.set_led(60).has_value());
    const auto armed = projector.arm(kDlpc350Timing);
    ASSERT_FALSE(armed.has_value()) << bit;
    EXPECT_EQ(armed.error().code, bit == 0 || bit == 4 ? ErrorCode::kBoardTiming : ErrorCode::kProjector) << bit;
    EXPECT_TRUE(said.insert(armed.error().detail).second) << armed.error().detail;
    EXPECT_EQ(model.leds, 0);
    EXPECT_THAT(projector.start().error().detail, HasSubstr("arm it first"));
    EXPECT_FALSE(model.runs);
  }
  model = {};
  model.also_invalid = 0x14;
  EXPECT_THAT(open().arm(kDlpc350Timing).error().detail,
              HasSubstr("TRIG_OUT_1 without an end, or black that overlaps; less than 230 us between"));
}

TEST_F(Projector350, tells_how_it_does) {
  Dlpc350 projector = open();
  model.hardware = 0x41;
  const auto s = projector.status();
  ASSERT_TRUE(s.has_value());
  EXPECT_EQ(s->type, "DLPC350");
  EXPECT_EQ(s->version, "8.7.261");
  EXPECT_FALSE(s->celsius.has_value());
  EXPECT_TRUE(s->initialised);
  EXPECT_TRUE(s->sequence_abort);
  EXPECT_FALSE(s->sequence_error || s->system_error);
  model.hardware = 0x81;
  EXPECT_TRUE(projector.status()->sequence_error);
  model.hardware = 0x09;
  EXPECT_TRUE(projector.status()->sequence_error);
  model.hardware = 0x05;
  EXPECT_TRUE(projector.status()->system_error);
  model.hardware = 1;
  model.system = 0;
  EXPECT_TRUE(projector.status()->system_error);
  EXPECT_FALSE(projector.pattern_status()->ready);
  EXPECT_FALSE(projector.pattern_status()->shown.has_value());
  model.version = {1, 0};
  EXPECT_THAT(projector.status().error().detail, HasSubstr("version (02.05): 2 bytes for an answer, not 4"));
}

}  // namespace
}  // namespace enamel::fw::test
