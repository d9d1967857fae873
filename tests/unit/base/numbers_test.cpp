#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "protocol/base/metrics.hpp"
#include "protocol/base/rng.hpp"

namespace enamel {
namespace {

TEST(Philox, gives_the_published_vectors) {  // kat_vectors of Random123 1.14
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (std::array<std::uint32_t, 4>{0x6627E8D5U, 0xE169C58DU, 0xBC57AC4CU, 0x9B00DBD8U}));
  EXPECT_EQ(philox4x32({0xFFFFFFFFU, 0xFFFFFFFFU, 0xFFFFFFFFU, 0xFFFFFFFFU}, {0xFFFFFFFFU, 0xFFFFFFFFU}),
            (std::array<std::uint32_t, 4>{0x408F276DU, 0x41C83B0EU, 0xA20BC7C6U, 0x6D5451FDU}));
  EXPECT_EQ(philox4x32({0x243F6A88U, 0x85A308D3U, 0x13198A2EU, 0x03707344U}, {0xA4093822U, 0x299F31D0U}),
            (std::array<std::uint32_t, 4>{0xD16CFE09U, 0x94FDCCEBU, 0x5001E420U, 0x24126EA1U}));
}
TEST(Rng, streams_differ_by_session_burst_and_stage) {
  const std::uint64_t a = Rng(1, 2, 3).next_u64();
  EXPECT_EQ(a, Rng(1, 2, 3).next_u64());
  EXPECT_NE(a, Rng(2, 2, 3).next_u64());
  EXPECT_NE(a, Rng(1, 3, 3).next_u64());
  EXPECT_NE(a, Rng(1, 2, 4).next_u64());
}
TEST(Rng, bits_are_pinned) {  // g++ and clang must give the same
  Rng r(42, 7, 1);
  EXPECT_EQ(r.next_u64(), 7034802919330396585U);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(r.uniform()), 4605895029125883356U);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(r.normal()), 4603473254335287682U);
}
TEST(Rng, moments_are_those_of_the_distributions) {
  Rng r(1, 1, 1);
  constexpr int kN = 200'000;
  double u1 = 0;
  double u2 = 0;
  double n1 = 0;
  double n2 = 0;
  double n4 = 0;
  for (int i = 0; i < kN; ++i) {
    const double u = r.uniform();
    ASSERT_TRUE(u >= 0.0 && u < 1.0);
    u1 += u;
    u2 += u * u;
    const double n = r.normal();
    n1 += n;
    n2 += n * n;
    n4 += n * n * n * n;
  }
  // Five standard errors of each moment.
  const double root = std::sqrt(static_cast<double>(kN));
  EXPECT_NEAR(u1 / kN, 0.5, 5 * 0.2887 / root);
  EXPECT_NEAR(u2 / kN, 1.0 / 3, 5 * 0.2981 / root);
  EXPECT_NEAR(n1 / kN, 0.0, 5 * 1.0 / root);
  EXPECT_NEAR(n2 / kN, 1.0, 5 * 1.4142 / root);
  EXPECT_NEAR(n4 / kN, 3.0, 5 * 9.798 / root);
}
TEST(Rng, below_stays_below_and_reaches_every_value) {
  Rng r(3, 1, 1);
  std::array<int, 6> seen{};
  for (int i = 0; i < 6'000; ++i) ++seen.at(r.below(6));
  for (const int n : seen) EXPECT_NEAR(n, 1000, 5 * 28.9);
}

TEST(LogHistogram, percentiles_are_within_one_sixteenth) {
  LogHistogram h;
  for (std::int64_t v = 1; v <= 100'000; ++v) h.record(v * 1'000);
  const LogHistogram::Summary s = h.summary();
  EXPECT_EQ(s.count, 100'000U);
  EXPECT_EQ(s.max, 100'000'000);
  EXPECT_DOUBLE_EQ(s.mean, 50'000'500.0);
  const auto close = [](std::int64_t got, double want) {
    return static_cast<double>(got) >= want && static_cast<double>(got) <= want * (1.0 + 1.0 / 16);
  };
  EXPECT_TRUE(close(s.p50, 50e6)) << s.p50;
  EXPECT_TRUE(close(s.p95, 95e6)) << s.p95;
  EXPECT_TRUE(close(s.p99, 99e6)) << s.p99;
}
TEST(LogHistogram, takes_extremes) {
  LogHistogram h;
  EXPECT_EQ(h.summary().count, 0U);
  h.record(-5);
  h.record(0);
  h.record(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(h.summary().count, 3U);
  EXPECT_EQ(h.summary().p50, 0);
  EXPECT_EQ(h.summary().max, std::numeric_limits<std::int64_t>::max());
}
TEST(Metrics, json_holds_every_metric) {
  MetricsRegistry m;
  m.counter("in \"quoted\"").add(3);
  m.gauge("depth").set(5);
  m.gauge("depth").set(2);
  m.histogram("time_ns").record(7);
  const auto j = nlohmann::json::parse(m.to_json());
  EXPECT_EQ(j.at("in \"quoted\""), 3);
  EXPECT_EQ(j.at("depth").at("value"), 2);
  EXPECT_EQ(j.at("depth").at("max"), 5);
  EXPECT_EQ(j.at("time_ns").at("p50"), 7);
}
TEST(MetricsDeathTest, one_name_is_one_kind) {
  MetricsRegistry m;
  m.counter("a");
  EXPECT_DEATH(m.gauge("a"), "two kinds");
}

}  // namespace
}  // namespace enamel
