// How messages to a DLPC350 travel, and what happens when they do not.
#include <gmock/gmock.h>

#include "firmware/device/linux/dlpc350/dlpc350.hpp"
#include "tests/unit/firmware/dlpc350_model.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {
namespace {

using testing::HasSubstr;
using Bytes = Dlpc350Model::Bytes;
using Fault = Dlpc350Model::Fault;

Result<void> light_up(Dlpc350Model& model) {
  VirtualClock clock;
  ENAMEL_TRY_ASSIGN(Dlpc350 projector, Dlpc350::open(model, clock, kDlpc350Limits, 0));
  ENAMEL_TRY(projector.arm(kDlpc350Timing));
  ENAMEL_TRY(projector.set_led(60));
  return projector.start();
}

TEST(Dlpc350Message, goes_on_in_further_reports) {
  const dlpc350::Command command{0x1A, 0x34, "mailbox data"};
  Bytes payload(130);
  for (std::size_t i = 0; i < payload.size(); ++i) payload[i] = static_cast<std::uint8_t>(i + 1);
  const auto reports = dlpc350::reports_of(command, dlpc350::Direction::kWrite, 7, payload);
  ASSERT_EQ(reports.size(), 3U);
  EXPECT_EQ(Bytes(reports[0].begin(), reports[0].begin() + 8), (Bytes{0x40, 7, 132, 0, 0x34, 0x1A, 1, 2}));
  EXPECT_EQ(reports[0][63], 58);
  EXPECT_EQ(reports[1][0], 59);
  EXPECT_EQ(reports[1][63], 122);
  EXPECT_EQ(reports[2][0], 123);
  EXPECT_EQ(reports[2][7], 130);
  EXPECT_EQ(reports[2][8], 0);
  EXPECT_EQ(dlpc350::reports_of(command, dlpc350::Direction::kWrite, 7, std::span(payload).first(58)).size(), 1U);
  EXPECT_EQ(dlpc350::reports_of(command, dlpc350::Direction::kWrite, 7, std::span(payload).first(59)).size(), 2U);
}

TEST(Dlpc350Message, of_any_length_arrives_and_its_answer_comes_back) {
  const dlpc350::Command mailbox{0x1A, 0x33, "mailbox"}, data{0x1A, 0x34, "mailbox data"};
  for (std::size_t size = 1; size <= 384; ++size) {
    Dlpc350Model model;
    dlpc350::Channel channel(model);
    Bytes payload(size);
    for (std::size_t i = 0; i < size; ++i) payload[i] = static_cast<std::uint8_t>(i * 7 + size);
    ASSERT_TRUE(channel.write(mailbox, Bytes{2}).has_value());
    ASSERT_TRUE(channel.write(data, payload).has_value());
    ASSERT_EQ(model.table, payload);
    const auto back = channel.read(data, size);
    ASSERT_TRUE(back.has_value()) << back.error().message();
    ASSERT_EQ(*back, payload);
  }
}

TEST(Dlpc350Message, answer_that_came_too_late_is_not_the_next_ones) {
  Dlpc350Model model;
  dlpc350::Channel channel(model);
  model.faults = [](int n) { return n == 0 ? Fault::kSilence : Fault::kNone; };
  EXPECT_FALSE(channel.read(dlpc350::kVersion, 16).has_value());
  model.say(Bytes{0xC0, 1, 1, 0, 0x55});
  const auto version = channel.read(dlpc350::kVersion, 16);
  ASSERT_TRUE(version.has_value()) << version.error().message();
  EXPECT_EQ(*version, model.version);
}

TEST(Dlpc350Message, answer_that_cannot_be_is_refused) {
  Dlpc350Model model;
  dlpc350::Channel channel(model);
  const auto why = [&](std::size_t size) {
    model.version.assign(size, 1);
    const auto said = channel.read(dlpc350::kVersion, 4);
    return said ? std::string("accepted") : said.error().detail;
  };
  EXPECT_EQ(why(512), "accepted");
  EXPECT_THAT(why(513), HasSubstr("an answer of 513 bytes"));
  EXPECT_THAT(why(0), HasSubstr("0 bytes for an answer, not 4"));
}

struct Trouble {
  Fault fault = Fault::kNone;
  const char* name = "";
  const char* says = "";
};
class Dlpc350Trouble : public testing::TestWithParam<Trouble> {};

/// Wherever it strikes: an error that names the command and a remedy, at once, and no light.
TEST_P(Dlpc350Trouble, is_told_and_the_light_is_off) {
  for (int strikes_at = 0; strikes_at < 1000; ++strikes_at) {
    Dlpc350Model model;
    model.faults = [&](int n) { return n == strikes_at ? GetParam().fault : Fault::kNone; };
    const auto lit = light_up(model);
    if (static_cast<int>(model.messages.size()) <= strikes_at) {
      EXPECT_TRUE(lit.has_value());
      EXPECT_GT(strikes_at, 30);
      return;
    }
    ASSERT_FALSE(lit.has_value()) << strikes_at;
    EXPECT_EQ(lit.error().code, ErrorCode::kProjector);
    EXPECT_THAT(lit.error().detail, HasSubstr(GetParam().says));
    EXPECT_THAT(lit.error().detail, testing::ContainsRegex("projector: .* .[01][0-9A-F][.][0-9A-F][0-9A-F].: "));
    EXPECT_EQ(model.leds, 0) << strikes_at;
    EXPECT_LE(model.waited, Nanoseconds{500'000'000});
  }
  FAIL() << "never lit";
}
INSTANTIATE_TEST_SUITE_P(Kinds, Dlpc350Trouble,
                         testing::Values(Trouble{Fault::kNack, "nack", "refused (NACK)"},
                                         Trouble{Fault::kSilence, "silence",
                                                 "no answer within 0.5 s: switch the projector off"},
                                         Trouble{Fault::kWrongSequence, "sequence", "does another program talk"},
                                         Trouble{Fault::kShort, "short", "an answer of 3 bytes: check the USB cable"}),
                         [](const auto& kind) { return std::string(kind.param.name); });

/// A controller that never answers again still hears that the light goes off.
TEST(Dlpc350Usb, silence_without_end_ends) {
  for (const int from : {0, 5, 20, 33}) {
    Dlpc350Model model;
    model.faults = [=](int n) { return n >= from ? Fault::kSilence : Fault::kNone; };
    EXPECT_FALSE(light_up(model).has_value());
    EXPECT_EQ(model.leds, 0);
    EXPECT_LE(model.waited, Nanoseconds{1'000'000'000});
  }
}

TEST(Dlpc350Usb, unplugged_anywhere_is_told) {
  int lit_after = 0;
  for (int after = 0; after < 1000 && lit_after == 0; ++after) {
    Dlpc350Model model;
    model.unplugged_after = after;
    const auto lit = light_up(model);
    if (lit) {
      lit_after = after;
      continue;
    }
    EXPECT_THAT(lit.error().detail, HasSubstr("unplugged"));
    EXPECT_EQ(lit.error().code, ErrorCode::kProjector);
  }
  EXPECT_GT(lit_after, 30);
}

TEST(Hidraw, device_that_is_not_there_is_told_with_the_remedy) {
  const auto port = open_hidraw("/dev/hidraw-nosuch");
  ASSERT_FALSE(port.has_value());
  EXPECT_EQ(port.error().code, ErrorCode::kProjector);
  EXPECT_THAT(port.error().detail, HasSubstr("USB cable"));
  EXPECT_THAT(open_hidraw("/dev/null").error().detail, HasSubstr("no HID device"));
}

}  // namespace
}  // namespace enamel::fw::test
