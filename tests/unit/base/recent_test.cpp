// Values made on demand: no more in memory than wanted, and whoever asks gets the same as if all were kept.
#include "protocol/base/recent.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace enamel {
namespace {

TEST(Recent, makes_each_value_once_where_all_fit_and_again_where_not) {
  std::atomic<int> made{0};
  const auto make = [&](std::size_t k) { return ++made, 10 * k; };
  const Recent<std::size_t> roomy(5, 5, make), tight(5, 2, make);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(*roomy.get(k), 10 * k);
  }
  EXPECT_EQ(made, 5);
  for (int round = 0; round < 3; ++round) {
    for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(*tight.get(k), 10 * k);
  }
  EXPECT_EQ(made, 5 + 15);
}

TEST(Recent, drops_what_was_not_asked_for_longest_and_nothing_that_somebody_holds) {
  std::vector<int> made(3);
  const Recent<std::size_t> recent(3, 2, [&](std::size_t k) { return ++made[k], k; });
  const auto held = recent.get(0);
  (void)recent.get(1);
  (void)recent.get(0);
  (void)recent.get(2);  // 1 goes
  (void)recent.get(0);
  EXPECT_EQ(made, (std::vector{1, 1, 1}));
  (void)recent.get(1);  // 2 goes
  (void)recent.get(2);  // 0 goes
  EXPECT_EQ(*held, 0U);
  (void)recent.get(0);
  EXPECT_EQ(made, (std::vector{2, 2, 2}));
}

TEST(Recent, threads_that_ask_for_the_same_get_the_same) {
  const Recent<std::size_t> recent(12, 3, [](std::size_t k) { return k; });
  std::atomic<int> wrong{0};
  std::vector<std::jthread> threads;
  for (std::size_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t n = 0; n < 500; ++n) wrong += *recent.get((n + t) % 12) == (n + t) % 12 ? 0 : 1;
    });
  }
  threads.clear();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace enamel
