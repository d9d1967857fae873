// A log that is shared while it grows: what a view shows, and what growing costs.
#include "protocol/base/append_log.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <thread>

#include "protocol/base/latest_slot.hpp"

namespace enamel {
namespace {

using Log = AppendLog<int, 4>;

TEST(AppendLog, holds_what_was_appended_in_order) {
  for (const int n : {0, 1, 3, 4, 5, 8, 1000}) {
    Log log;
    for (int i = 0; i < n; ++i) log.append(i);
    std::vector<int> expected(static_cast<std::size_t>(n));
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(log.view().in_order(), expected);
    EXPECT_EQ(log.view().empty(), n == 0);
  }
}

TEST(AppendLog, a_view_stays_as_it_was_taken) {
  Log log;
  for (int i = 0; i < 6; ++i) log.append(i);
  const Log::View early = log.view();
  for (int i = 6; i < 30; ++i) log.append(i);
  EXPECT_EQ(early.in_order(), (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(log.view().size(), 30U);
  log = Log();
  EXPECT_EQ(early.in_order(), (std::vector<int>{0, 1, 2, 3, 4, 5})) << "a view outlives its log";
}

/// Counts how often one of it is written or copied.
struct Counted {
  Counted() = default;
  Counted(const Counted&) { ++copies; }
  Counted(Counted&&) noexcept { ++copies; }
  Counted& operator=(const Counted&) {
    ++copies;
    return *this;
  }
  Counted& operator=(Counted&&) noexcept {
    ++copies;
    return *this;
  }
  ~Counted() = default;
  static inline std::size_t copies = 0;
};

/// Elements touched while one is appended to `before` others and the result is shared.
template <class Append>
std::size_t touched_by_the_next(std::size_t before, Append append) {
  for (std::size_t i = 0; i < before; ++i) append();
  Counted::copies = 0;
  append();
  return Counted::copies;
}

TEST(AppendLog, appending_and_sharing_cost_the_same_however_many_came_before) {
  const auto of_log = [](std::size_t before) {
    AppendLog<Counted> log;
    AppendLog<Counted>::View shared;
    return touched_by_the_next(before, [&] {
      log.append(Counted());
      shared = log.view();
    });
  };
  EXPECT_EQ(of_log(10), of_log(10'000));
  EXPECT_EQ(of_log(255), of_log(25'599)) << "where a chunk begins";
  const auto of_copies = [](std::size_t before) {  // control: a vector that is copied to be shared
    auto shared = std::make_shared<const std::vector<Counted>>();
    return touched_by_the_next(before, [&] {
      auto next = *shared;
      next.emplace_back();
      shared = std::make_shared<const std::vector<Counted>>(std::move(next));
    });
  };
  EXPECT_GT(of_copies(1'000), 10 * of_copies(10));
}

TEST(AppendLog, a_long_one_is_given_back_without_recursion) {
  AppendLog<int, 1> log;
  for (int i = 0; i < 1'000'000; ++i) log.append(i);
  EXPECT_EQ(log.view().size(), 1'000'000U);  // its end would overflow the stack
}

TEST(AppendLog, is_read_while_it_grows) {
  LatestSlot<Log::View> slot;
  constexpr int kLast = 20'000;
  std::jthread writer([&slot] {
    Log log;
    for (int i = 0; i < kLast; ++i) {
      log.append(i);
      slot.put(log.view());
    }
  });
  std::size_t seen = 0;
  while (seen < kLast) {
    if (const auto view = slot.take()) {
      int expected = static_cast<int>(view->size());
      view->newest_first([&](int item) { ASSERT_EQ(item, --expected); });
      ASSERT_EQ(expected, 0);
      seen = view->size();
    }
  }
}

}  // namespace
}  // namespace enamel
