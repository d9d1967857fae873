// Which bursts belong to a stop, whatever the link's clocks are off by, and where all others are counted.
#include "host/desktop/rest_window.hpp"

#include <gtest/gtest.h>

#include "host/desktop/take_counts.hpp"
#include "protocol/base/rng.hpp"

namespace enamel::host {
namespace {

constexpr std::int64_t kSince = 10'000'000'000, kUntil = 12'000'000'000;
constexpr std::int64_t kBurstNs = 15'712'000;  // four frames

struct Drawn {
  HostExposure seen;
  std::int64_t began_ns = 0;  ///< in truth
};

/// About an instant, seen by a clock map that is off by no more than it says.
Drawn draw(Rng& rng, std::int64_t about_ns) {
  Drawn d;
  const std::int64_t uncertainty = static_cast<std::int64_t>(rng.uniform(1e4, 5e6));
  const auto error = static_cast<std::int64_t>(rng.uniform(-1.0, 1.0) * static_cast<double>(uncertainty));
  d.began_ns = about_ns + static_cast<std::int64_t>(rng.uniform(-3e7, 3e7));
  d.seen = {host_time(d.began_ns + error), host_time(d.began_ns + error + kBurstNs), Nanoseconds{uncertainty}};
  return d;
}

TEST(RestWindow, takes_no_burst_that_may_have_begun_before_the_table_stood) {
  RestWindow window;
  window.open(host_time(kSince));
  Rng rng(1, 0, 0);
  int taken = 0, caught_without_margin = 0;
  for (int i = 0; i < 20000; ++i) {
    Drawn d = draw(rng, kSince);
    const bool is_taken = window.place_of(d.seen) == BurstPlace::kAtStop;
    taken += is_taken ? 1 : 0;
    if (is_taken) {
      EXPECT_GE(d.began_ns, kSince);
    }
    if (d.began_ns - 2 * d.seen.uncertainty.count() > kSince) {
      EXPECT_TRUE(is_taken) << "lost without need";
    }
    d.seen.uncertainty = Nanoseconds{0};
    const bool without = window.place_of(d.seen) == BurstPlace::kAtStop;
    caught_without_margin += without && d.began_ns < kSince ? 1 : 0;
  }
  EXPECT_GT(taken, 5000);
  EXPECT_GT(caught_without_margin, 0) << "without the margin some would be wrong: the test can fail";
}

TEST(RestWindow, what_comes_late_from_a_table_at_rest_is_spare_and_the_rest_moving) {
  RestWindow window;
  const auto at = [](std::int64_t ns) {
    return HostExposure{host_time(ns), host_time(ns + kBurstNs), Nanoseconds{1000}};
  };
  EXPECT_EQ(window.place_of(at(kSince + 1'000'000)), BurstPlace::kMoving) << "nobody said that it stands";
  EXPECT_EQ(window.place_of(std::nullopt), BurstPlace::kMoving);
  EXPECT_FALSE(window.is_open());
  window.open(host_time(kSince));
  EXPECT_TRUE(window.is_open());
  EXPECT_EQ(window.place_of(std::nullopt), BurstPlace::kMoving) << "the clocks were not compared yet";
  window.close(host_time(kUntil));
  EXPECT_EQ(window.place_of(at(kUntil - kBurstNs - 2000)), BurstPlace::kSpare);
  EXPECT_EQ(window.place_of(at(kUntil - kBurstNs)), BurstPlace::kMoving) << "its end may lie behind";
  EXPECT_EQ(window.place_of(at(kUntil + 1)), BurstPlace::kMoving);
  window.open(host_time(kUntil + 1'000'000'000));
  EXPECT_EQ(window.place_of(at(kSince + 1'000'000)), BurstPlace::kMoving) << "of the stop before: too late";
}

TEST(TakeCounts, balance_or_say_what_does_not) {
  BurstCounts ledger;
  ledger.captured = 20;
  ledger.accepted = 9;
  ledger.shed = 9;  // 5 moving, 2 spare, 2 by the probe's own queue
  ledger.incomplete = 1;
  ledger.lost_on_wire = 1;
  const TakeCounts counts = take_counts(ledger, 5, 2);
  EXPECT_EQ(counts.incomplete, 3U);
  EXPECT_EQ(check(counts).error().code, ErrorCode::kDataLoss);
  TakeCounts good = counts;
  good.captured = 16;
  good.incomplete = good.lost = 0;
  EXPECT_TRUE(check(good));
  ++good.captured;
  EXPECT_EQ(check(good).error().code, ErrorCode::kAccounting);
}

}  // namespace
}  // namespace enamel::host
