#include <gmock/gmock.h>

#include <array>
#include <set>
#include <sstream>

#include "protocol/base/check.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/ids.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/progress.hpp"
#include "protocol/base/result.hpp"
#include "protocol/base/utc.hpp"

namespace enamel {
namespace {

using ::testing::HasSubstr;

template <class A, class B>
concept Comparable = requires(A a, B b) {
  a == b;
};
template <class A, class B>
concept Subtractable = requires(A a, B b) {
  a - b;
};

TEST(Ids, are_distinct_types) {
  static_assert(Comparable<BurstId, BurstId>);
  static_assert(!Comparable<BurstId, SessionId>);
  static_assert(!std::is_convertible_v<int, BurstId>);
  EXPECT_LT(BurstId{1}, BurstId{2});
}
TEST(Time, host_and_device_do_not_mix) {
  static_assert(Subtractable<HostTime, HostTime>);
  static_assert(!Subtractable<HostTime, DeviceTime>);
  EXPECT_EQ(to_ns(device_time(5) + Nanoseconds{3}), 8);
}

constexpr auto kAllCodes = std::to_array<std::pair<ErrorCode, std::string_view>>({
#define ENAMEL_ERROR(id, number, text, cause, remedy) {ErrorCode::id, #id},
#include "protocol/base/error_codes.def"
#undef ENAMEL_ERROR
});
TEST(Result, every_code_has_text_cause_remedy_and_exit_class) {
  std::set<int> numbers;
  for (const auto& [code, id] : kAllCodes) {
    EXPECT_TRUE(numbers.insert(static_cast<int>(code)).second) << id << " shares its number";
    const ErrorInfo info = describe(code);
    EXPECT_EQ(info.name, id);
    EXPECT_FALSE(info.text.empty() || info.cause.empty() || info.remedy.empty()) << id;
    EXPECT_TRUE(exit_code(code) >= 1 && exit_code(code) <= 6) << id;
  }
}
TEST(Result, message_gives_detail_cause_and_remedy) {
  const std::string m = Error{ErrorCode::kFileNotFound, "a.png"}.message();
  EXPECT_THAT(m, HasSubstr("file not found: a.png"));
  EXPECT_THAT(m, HasSubstr("likely cause: "));
  EXPECT_THAT(m, HasSubstr("what to do: "));
}
TEST(Result, try_returns_the_error_and_assigns_the_value) {
  const auto half = [](int v) -> Result<int> {
    if (v % 2 != 0) return fail(ErrorCode::kUsage, "odd");
    return v / 2;
  };
  const auto quarter = [&](int v) -> Result<int> {
    ENAMEL_TRY_ASSIGN(const int h, half(v));
    ENAMEL_TRY(half(h));
    return half(h);
  };
  EXPECT_EQ(quarter(8).value(), 2);
  EXPECT_EQ(quarter(6).error().detail, "odd");
  EXPECT_EQ(quarter(3).error().code, ErrorCode::kUsage);
}

TEST(WallTime, is_told_as_utc_texts_that_sort) {
  const auto at = [](std::int64_t ms) { return utc_text_ms(WallTime(std::chrono::milliseconds(ms))); };
  EXPECT_EQ(at(1'767'225'600'007), "2026-01-01T00:00:00.007Z");
  EXPECT_EQ(at(1'772'323'199'999), "2026-02-28T23:59:59.999Z");
  EXPECT_LT(at(1'772'323'199'999), at(1'772'323'200'000));
}

TEST(WallTime, dates_read_back) {
  const WallTime time(std::chrono::seconds(1'772'323'199));
  EXPECT_EQ(utc_text(time), "2026-02-28T23:59:59Z");
  EXPECT_EQ(parse_utc(utc_text(time)), time);
  EXPECT_FALSE(parse_utc("28.2.2026"));
  EXPECT_FALSE(parse_utc("2026-02-28T23:59:59Z and more"));
}

TEST(Clock, steady_clock_never_goes_back) {
  const SteadyClock clock;
  const HostTime a = clock.now();
  EXPECT_LE(a, clock.now());
}
TEST(Clock, steady_clock_sleeps_at_least_until) {
  SteadyClock clock;
  const HostTime until = clock.now() + Nanoseconds{1'000'000};
  clock.sleep_until(until);
  EXPECT_GE(clock.now(), until);
  clock.sleep_until(until - Nanoseconds{1'000'000'000});  // in the past: returns
}
TEST(Clock, manual_clock_moves_only_when_moved) {
  ManualClock clock(host_time(100));
  EXPECT_EQ(to_ns(clock.now()), 100);
  clock.advance(Nanoseconds{50});
  EXPECT_EQ(to_ns(clock.now()), 150);
  clock.sleep_until(host_time(150));
}

TEST(CheckDeathTest, fails_with_expression_and_meaning) {
  EXPECT_DEATH(ENAMEL_CHECK(1 + 1 == 3, "arithmetic"), "check failed: 1 \\+ 1 == 3 arithmetic");
}
TEST(Check, passing_check_does_nothing) { ENAMEL_CHECK(true); }
TEST(Check, handler_can_be_replaced) {
  const CheckHandler before = set_check_handler(
      [](const char* expression, const char*, int, std::string_view) { throw std::string(expression); });
  EXPECT_THROW(ENAMEL_CHECK(false), std::string);
  set_check_handler(before);
}

TEST(Log, writes_level_module_and_text_to_stderr) {
  ::testing::internal::CaptureStderr();
  log::set_level(log::Level::kInfo);
  log::info("unit", "burst {} of {}", 3, 7);
  log::debug("unit", "hidden");
  log::set_level(log::Level::kOff);
  log::error("unit", "off means off");
  log::set_level(log::Level::kInfo);
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_THAT(text, ::testing::ContainsRegex("I [0-9]+ +[0-9]+\\.[0-9]+ \\[unit\\] burst 3 of 7\n"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("hidden")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("off means")));
}
TEST(Log, unknown_level_is_refused) {
  EXPECT_EQ(log::parse_level("debug").value(), log::Level::kDebug);
  EXPECT_EQ(log::parse_level("loud").error().code, ErrorCode::kConfigValue);
}

TEST(Progress, lines_appear_at_their_interval_with_rest_time) {
  ManualClock clock;
  std::ostringstream out;
  Progress p(clock, "decode", 100, out, Progress::Target::kLines);
  p.update(10);
  EXPECT_EQ(out.str(), "");
  clock.advance(Nanoseconds{2'000'000'000});
  p.update(20);
  EXPECT_EQ(out.str(), "decode: 20/100 (20 %), 2 s, 8 s left\n");
  p.advance(5);
  EXPECT_EQ(out.str(), "decode: 20/100 (20 %), 2 s, 8 s left\n") << "no second line before the interval is over";
  clock.advance(Nanoseconds{118'000'000'000});
  p.update(100);
  p.finish();
  p.finish();
  EXPECT_THAT(out.str(), ::testing::EndsWith("decode: 100/100 (100 %), 2:00 min\ndecode: 100/100 (100 %), 2:00 min\n"));
}
TEST(Progress, terminal_gets_one_updating_line) {
  ManualClock clock;
  std::ostringstream out;
  {
    Progress p(clock, "scan", 0, out, Progress::Target::kTerminal);
    clock.advance(Nanoseconds{100'000'000});
    p.update(3);
  }
  EXPECT_EQ(out.str(), "\rscan: 3, 0 s\x1b[K\rscan: 3, 0 s\x1b[K\n");
}

}  // namespace
}  // namespace enamel
