#include "pipeline/decode/phase/row_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

namespace enamel::pipeline {
namespace {

TEST(RowMemory, what_one_gave_back_the_next_one_takes) {
  const float* first = nullptr;
  {
    RowMemory row(100003, 1.0F);
    first = row.data();
  }
  RowMemory again(100001), other(100001);
  EXPECT_EQ(again.data(), first);
  EXPECT_NE(other.data(), first);
}

TEST(RowMemory, rows_in_use_are_never_shared_whatever_their_order) {
  std::vector<RowMemory> rows;
  for (std::size_t round = 0; round < 40; ++round) {
    for (std::size_t k = 0; k < 50; ++k) rows.emplace_back(100 + 13 * k, static_cast<float>(rows.size()));
    for (std::size_t k = 0; k < rows.size(); ++k)
      ASSERT_TRUE(std::all_of(rows[k].data(), rows[k].data() + rows[k].size(),
                              [k](float x) { return x == static_cast<float>(k); }));
    RowMemory moved = std::move(rows[round % rows.size()]);
    EXPECT_GT(moved.size(), 0U);
    rows.clear();
  }
}

TEST(RowMemory, threads_keep_their_own) {
  const float* here = nullptr;
  {
    RowMemory row(4321);
    here = row.data();
  }
  const float* there = here;
  std::jthread([&there] { there = RowMemory(4321).data(); }).join();
  EXPECT_NE(there, here);
  EXPECT_EQ(RowMemory(4321).data(), here);
}

}  // namespace
}  // namespace enamel::pipeline
