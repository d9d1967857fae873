// The projector's driver against a MODEL of its controller, byte by byte against TI's table of commands.
#include "firmware/device/linux/dlpc347x/dlpc347x.hpp"

#include <gmock/gmock.h>

#include "calib/model/rig_reader.hpp"
#include "firmware/device/linux/dlpc347x/trigger_timing.hpp"
#include "tests/unit/firmware/dlpc347x_model.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Bytes = Dlpc347xModel::Bytes;

class Projector347x : public testing::Test {
 protected:
  Dlpc347x open() {
    auto projector = Dlpc347x::open(model, clock, {});
    EXPECT_TRUE(projector.has_value()) << projector.error().message();
    model.written.clear();
    return *projector;
  }
  std::string why_not_open() {
    const auto projector = Dlpc347x::open(model, clock, {});
    EXPECT_FALSE(projector.has_value());
    return projector ? "" : projector.error().detail;
  }
  Dlpc347xModel model;
  VirtualClock clock;
};

TEST_F(Projector347x, is_opened_dark_and_under_the_ceiling) {
  ASSERT_TRUE(Dlpc347x::open(model, clock, {.max_led_code = 0x0190, .leds = kBlueLed}).has_value());
  EXPECT_THAT(model.written, ElementsAre(Bytes{0x52, 0}, Bytes{0x5C, 0, 0, 0, 0, 0x90, 0x01}, Bytes{0x80, 0, 0},
                                         Bytes{0x84, 0, 31, 0}, Bytes{0x86, 0}, Bytes{0x50, 0}));
  EXPECT_EQ(model.leds, 0);
}

TEST_F(Projector347x, is_waited_for_while_it_boots) {
  model.boots_after = 20;
  model.busy_after_boot = 10;
  open();
}

TEST_F(Projector347x, that_cannot_be_used_is_told_why) {
  model.boots_after = 1'000'000;
  EXPECT_THAT(why_not_open(), HasSubstr("no answer"));
  model = {};
  model.busy_after_boot = 1'000'000;
  EXPECT_THAT(why_not_open(), HasSubstr("not ready after 3.0 s"));
  model = {};
  model.main_application = false;
  EXPECT_THAT(why_not_open(), HasSubstr("boot loader"));
  model = {};
  model.controller = 0x42;
  EXPECT_THAT(why_not_open(), HasSubstr("0x42"));
  model = {};
  model.keeps_ceiling = false;
  EXPECT_THAT(why_not_open(), HasSubstr("ceiling"));
  EXPECT_EQ(model.leds, 0);
}

TEST_F(Projector347x, is_armed_in_the_order_in_which_it_takes_effect) {
  Dlpc347x projector = open();
  ASSERT_TRUE(projector.arm({}).has_value());
  Bytes entry(25, 0);
  entry[0] = 0x98;
  entry[1] = 2;
  EXPECT_THAT(model.written, ElementsAre(Bytes{0x90, 3}, Bytes{0x92, 2, 0, 0, 0, 0}, Bytes{0x92, 3, 0, 0, 0, 0},
                                         Bytes{0x94, 3}, entry, Bytes{0x05, 4}));
  EXPECT_TRUE(model.triggered);
  model.written.clear();
  ASSERT_TRUE(projector.start().has_value());
  ASSERT_TRUE(projector.stop().has_value());
  EXPECT_THAT(model.written, ElementsAre(Bytes{0x9E, 0, 0xFF}, Bytes{0x9E, 1, 0}));
}

TEST_F(Projector347x, says_what_a_pattern_needs) {
  Dlpc347x projector = open();
  EXPECT_TRUE(projector.validate({}).has_value());
  const auto shorter = projector.validate({.illum_us = 1000});
  ASSERT_FALSE(shorter.has_value());
  EXPECT_EQ(shorter.error().code, ErrorCode::kBoardTiming);
  EXPECT_THAT(shorter.error().detail, HasSubstr("it needs 1677, 171 and 31"));
  EXPECT_FALSE(projector.validate({.pre_us = 100}).has_value());
  EXPECT_FALSE(projector.validate({.bits = 7}).has_value());
  EXPECT_FALSE(projector.arm({.illum_us = 1000}).has_value());
  EXPECT_FALSE(model.triggered);
}

TEST_F(Projector347x, that_never_gets_ready_is_given_up) {
  Dlpc347x projector = open();
  model.never_ready = true;
  const auto armed = projector.arm({});
  ASSERT_FALSE(armed.has_value());
  EXPECT_THAT(armed.error().detail, HasSubstr("not ready for a trigger after 0.5 s"));
}

TEST_F(Projector347x, light_never_passes_the_ceiling) {
  Dlpc347x projector = open();
  EXPECT_FALSE(projector.set_led(401).has_value());
  EXPECT_TRUE(model.written.empty());
  ASSERT_TRUE(projector.set_led(400).has_value());
  EXPECT_THAT(model.written, ElementsAre(Bytes{0x54, 0, 0, 0, 0, 0x90, 0x01}, Bytes{0x52, kBlueLed}));
  projector.blank();
  EXPECT_EQ(model.leds, 0);
}

TEST_F(Projector347x, patterns_are_written_in_blocks_and_read_back) {
  Dlpc347x projector = open();
  Bytes block(3500);
  for (std::size_t i = 0; i < block.size(); ++i) block[i] = static_cast<std::uint8_t>(i * 7);
  ASSERT_TRUE(projector.load(block).has_value());
  EXPECT_EQ(model.flash, block);
  EXPECT_EQ(model.wrong_order, 0);
  model.spoiled_byte = 700;
  const auto spoiled = projector.load(block);
  ASSERT_FALSE(spoiled.has_value());
  EXPECT_THAT(spoiled.error().detail, HasSubstr("from byte 512 on"));
  model.spoiled_byte = -1;
  model.never_erased = true;
  EXPECT_THAT(projector.load(block).error().detail, HasSubstr("still being erased after 30.0 s"));
}

TEST_F(Projector347x, tells_how_it_does) {
  Dlpc347x projector = open();
  model.system[1] = 0x20;
  model.system[2] = 0x01;
  model.system[3] = 0x20;
  const auto s = projector.status();
  ASSERT_TRUE(s.has_value());
  EXPECT_EQ(s->type, "DLPC3470");
  EXPECT_EQ(s->version, "8.7.261");
  EXPECT_NEAR(s->celsius.value_or(0), 34.7, 1e-9);
  EXPECT_TRUE(s->sequence_abort);
  EXPECT_TRUE(s->watchdog);
  EXPECT_FALSE(s->sequence_error);
  EXPECT_EQ(s->led_errors, kBlueLed);
}

/// A bus that fails anywhere is an error there, never a wait without end or an unlimited light.
TEST_F(Projector347x, bus_that_fails_anywhere_is_told) {
  for (int fails_at = 0; fails_at < 200; ++fails_at) {
    model = {};
    model.refuses = [&](int n) { return n >= fails_at; };
    auto projector = Dlpc347x::open(model, clock, {});
    const bool armed = projector && projector->arm({}) && projector->start();
    if (!armed) continue;
    EXPECT_GT(fails_at, 10);
    return;
  }
  FAIL() << "never armed";
}

// Read back by the format's own words, with another walk than the encoder's.
std::uint32_t word(const Bytes& b, std::size_t at) {
  return b[at] | (std::uint32_t{b[at + 1]} << 8U) | (std::uint32_t{b[at + 2]} << 16U) |
         (std::uint32_t{b[at + 3]} << 24U);
}

TEST(PatternBlock, holds_the_rigs_patterns_bit_by_bit) {
  for (const char* name : {"probe.json", "probe_t.json"}) {
    const auto rig = calib::load_rig(std::string(ENAMEL_SOURCE_DIR "/config/rigs/") + name);
    ASSERT_TRUE(rig.has_value());
    const auto block = pattern_block(*rig, kDlp2010, {}, kBlueLed);
    ASSERT_TRUE(block.has_value()) << block.error().message();
    const Bytes& b = *block;
    EXPECT_EQ(std::string(b.begin(), b.begin() + 4), "PATN");
    const std::uint32_t sets = word(b, 4), order = word(b, 12);
    EXPECT_EQ(sets + word(b, 8), b.size());
    EXPECT_EQ(order, 20U);
    EXPECT_EQ(order + word(b, 16), sets);
    EXPECT_EQ(word(b, order), 1U);
    EXPECT_THAT(Bytes(b.begin() + 24, b.begin() + 28), ElementsAre(0, 4, kBlueLed, 0));
    EXPECT_EQ(word(b, 36), 3464U);
    EXPECT_EQ(word(b, 40), 171U);
    EXPECT_EQ(word(b, 44), 31U);
    const std::uint32_t set = word(b, sets + 4);
    EXPECT_THAT(Bytes(b.begin() + set, b.begin() + set + 4), ElementsAre(4, 1, 8, 0));
    EXPECT_EQ(word(b, set + 4), 3456U);
    const auto table = calib::pattern_table(*rig);
    constexpr std::size_t kPlane = 108;
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t x = 0; x < 854; ++x) {
        unsigned level = 0;
        for (std::size_t plane = 0; plane < 8; ++plane) {
          const std::size_t at = set + 8 + (8 * k + plane) * kPlane + x / 8;
          level |= ((unsigned{b[at]} >> (x % 8)) & 1U) << plane;
        }
        ASSERT_EQ(level, table.frames[k][x]) << name << " frame " << k << " pixel " << x;
      }
    }
  }
}

TEST(PatternBlock, of_another_projector_is_refused) {
  const auto rig = calib::load_rig(ENAMEL_SOURCE_DIR "/config/rigs/probe.json");
  ASSERT_TRUE(rig.has_value());
  const auto other = pattern_block(*rig, kDlp3010, {}, kBlueLed);
  ASSERT_FALSE(other.has_value());
  EXPECT_THAT(other.error().detail, HasSubstr("854x480"));
  EXPECT_EQ(pattern_block(*rig, kDlp2010, {.bits = 9}, kBlueLed).error().code, ErrorCode::kConfigValue);
}

TEST(TriggerTiming, of_the_probes_fits_and_says_what_does_not) {
  EXPECT_THAT(timing_faults({}), testing::IsEmpty());
  EXPECT_THAT(timing_faults({.exposure_us = 3700}), ElementsAre(HasSubstr("the exposure ends after 3700 us")));
  EXPECT_THAT(timing_faults({.frame_lines = 422}),
              ElementsAre(HasSubstr("the exposure takes 3776 us, but the frame leaves 3613 us")));
  EXPECT_THAT(timing_faults({.pattern = {.pre_us = 0}}), ElementsAre(HasSubstr("come on")));
  EXPECT_THAT(timing_faults({.pattern = {.post_us = 400}}), ElementsAre(HasSubstr("ready again after 4085 us")));
  EXPECT_EQ(timing_faults({.pattern = {.illum_us = 4000}}).size(), 2U);
}

TEST(I2c, bus_that_is_not_there_is_told_with_the_remedy) {
  const auto bus = open_i2c("/dev/i2c-nosuch", kDlpcAddress);
  ASSERT_FALSE(bus.has_value());
  EXPECT_EQ(bus.error().code, ErrorCode::kProjector);
  EXPECT_THAT(bus.error().detail, HasSubstr("device tree"));
  EXPECT_FALSE(open_i2c("/dev/null", kDlpcAddress).has_value());
}

}  // namespace
}  // namespace enamel::fw::test
