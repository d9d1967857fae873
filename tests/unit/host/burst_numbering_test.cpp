#include "host/session/burst_numbering.hpp"

#include <gtest/gtest.h>

namespace enamel::host {
namespace {

proto::Burst burst(std::uint64_t seq, std::uint64_t index) {
  proto::Burst b;
  b.burst_seq = seq;
  b.burst_index = index;
  return b;
}

TEST(BurstNumbering, keeps_the_probes_own_numbers_within_one_life) {
  BurstNumbering numbering;
  EXPECT_EQ(numbering.number(burst(3, 5)).value, 5U);
  EXPECT_EQ(numbering.number(burst(4, 6)).value, 6U);
  EXPECT_EQ(numbering.number(burst(6, 9)).value, 9U) << "a gap stays a gap";
}

TEST(BurstNumbering, a_restarted_probe_goes_on_behind_the_last_number) {
  BurstNumbering numbering;
  static_cast<void>(numbering.number(burst(0, 0)));
  static_cast<void>(numbering.number(burst(7, 7)));
  EXPECT_EQ(numbering.number(burst(0, 0)).value, 8U);
  EXPECT_EQ(numbering.number(burst(1, 1)).value, 9U);
  EXPECT_EQ(numbering.number(burst(0, 4)).value, 10U) << "and again";
}

TEST(BurstNumbering, never_gives_a_number_twice) {
  BurstNumbering numbering;
  std::uint64_t last = numbering.number(burst(0, 2)).value;
  for (const auto& b : {burst(1, 2), burst(2, 1), burst(2, 50), burst(1, 60)}) {
    const std::uint64_t next = numbering.number(b).value;
    EXPECT_GT(next, last);
    last = next;
  }
}

}  // namespace
}  // namespace enamel::host
