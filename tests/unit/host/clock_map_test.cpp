#include "host/ingest/clock_map.hpp"

#include <gtest/gtest.h>

namespace enamel::host {
namespace {

constexpr std::int64_t kOffset = 5'000'000'000;  // device clock ahead of the host's

TEST(ClockMap, knows_nothing_before_the_first_exchange) {
  const ClockMap map;
  EXPECT_FALSE(map.to_host(device_time(1)));
  EXPECT_FALSE(map.uncertainty());
}

TEST(ClockMap, maps_exactly_on_a_symmetric_link) {
  ClockMap map;
  map.add(1000, 1000 + 200 + kOffset, 1000 + 250 + kOffset, 1000 + 450);
  EXPECT_EQ(to_ns(*map.to_host(device_time(kOffset + 77))), 77);
  EXPECT_EQ(map.uncertainty()->count(), 200);
}

TEST(ClockMap, trusts_the_shortest_round_trip) {
  ClockMap map;
  map.add(0, 100 + kOffset, 110 + kOffset, 210);
  map.add(10'000, 10'100 + kOffset, 10'110 + kOffset, 90'000);  // answer was late: would be off by 40 µs
  EXPECT_EQ(to_ns(*map.to_host(device_time(kOffset))), 0);
}

TEST(ClockMap, error_stays_within_the_stated_uncertainty) {
  ClockMap map;
  map.add(0, 1 + kOffset, 2 + kOffset, 1002);  // all of the delay on the way back
  const std::int64_t error = to_ns(*map.to_host(device_time(kOffset)));
  EXPECT_LE(std::abs(error), map.uncertainty()->count());
}

TEST(ClockMap, ignores_an_exchange_that_cannot_be) {
  ClockMap map;
  map.add(1000, 0, 900, 1500);  // device needed longer than the round trip took: a clock was stepped
  EXPECT_FALSE(map.uncertainty());
}

}  // namespace
}  // namespace enamel::host
