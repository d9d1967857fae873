// Stress of the lock-free parts; meant to run under the thread sanitizer as well.
#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "protocol/base/latest_slot.hpp"
#include "protocol/base/pool.hpp"
#include "protocol/base/spsc_ring.hpp"

namespace enamel {
namespace {

TEST(SpscRing, keeps_order_and_refuses_when_full) {
  SpscRing<int> ring(3);
  EXPECT_EQ(ring.front(), nullptr);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_FALSE(ring.push(9)) << "capacity is what was asked for, not the next power of two";
  EXPECT_EQ(ring.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), i);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}
TEST(SpscRing, failed_push_leaves_the_item) {
  SpscRing<std::unique_ptr<int>> ring(1);
  ASSERT_TRUE(ring.push(std::make_unique<int>(1)));
  auto second = std::make_unique<int>(2);
  EXPECT_FALSE(ring.push(std::move(second)));
  EXPECT_NE(second, nullptr);
}
TEST(SpscRing, popped_slot_keeps_nothing_alive) {
  SpscRing<std::shared_ptr<int>> ring(2);
  const auto value = std::make_shared<int>(1);
  ASSERT_TRUE(ring.push(value));
  ring.pop();
  EXPECT_EQ(value.use_count(), 1);
}
TEST(SpscRing, stress_delivers_everything_once_in_order) {
  constexpr std::uint64_t kItems = 20'000;
  SpscRing<std::vector<std::uint64_t>> ring(8);
  std::jthread producer([&] {
    for (std::uint64_t i = 0; i < kItems;) {
      if (ring.push({i, i * i})) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (std::uint64_t expected = 0; expected < kItems;) {
    if (const auto* item = ring.front()) {
      ASSERT_EQ((*item)[0], expected);
      ASSERT_EQ((*item)[1], expected * expected);
      ring.pop();
      ++expected;
    } else {
      std::this_thread::yield();
    }
  }
}
TEST(SpscRingDeathTest, zero_capacity_is_refused) { EXPECT_DEATH(SpscRing<int>(0), "capacity > 0"); }

TEST(LatestSlot, newest_replaces_and_is_counted) {
  LatestSlot<std::shared_ptr<int>> slot;
  EXPECT_FALSE(slot.take().has_value());
  const auto old = std::make_shared<int>(1);
  EXPECT_FALSE(slot.put(old));
  EXPECT_TRUE(slot.put(std::make_shared<int>(2)));
  EXPECT_EQ(old.use_count(), 1) << "the replaced item goes back at once";
  EXPECT_EQ(slot.replaced(), 1U);
  EXPECT_TRUE(slot.full());
  EXPECT_EQ(**slot.take(), 2);
  EXPECT_FALSE(slot.take().has_value());
  EXPECT_FALSE(slot.put(std::make_shared<int>(3))) << "a taken item was not replaced";
}
TEST(LatestSlot, stress_reader_sees_whole_items_in_order_and_every_item_is_accounted_for) {
  constexpr std::uint64_t kItems = 20'000;
  LatestSlot<std::vector<std::uint64_t>> slot;
  std::jthread writer([&] {
    for (std::uint64_t i = 1; i <= kItems; ++i) slot.put({i, ~i});
  });
  std::uint64_t last = 0;
  std::uint64_t taken = 0;
  while (last < kItems) {
    if (const auto item = slot.take()) {
      ASSERT_EQ(item->size(), 2U);
      ASSERT_EQ((*item)[1], ~(*item)[0]);
      ASSERT_GT((*item)[0], last);
      last = (*item)[0];
      ++taken;
    }
  }
  writer.join();
  EXPECT_EQ(taken + slot.replaced(), kItems);
}

TEST(IndexQueue, is_bounded_and_in_order) {
  IndexQueue q(3);  // rounded up to 4 cells
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_TRUE(q.push(i));
  EXPECT_FALSE(q.push(4));
  std::uint32_t v = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(q.pop(v));
    EXPECT_EQ(v, i);
  }
  EXPECT_FALSE(q.pop(v));
}
TEST(Pool, reuses_objects_and_reports_exhaustion) {
  int made = 0;
  Pool<std::vector<int>> pool(2, [&] { return std::vector<int>(static_cast<std::size_t>(++made)); });
  {
    Ref<std::vector<int>> a = pool.acquire();
    const Ref<const std::vector<int>> b = pool.acquire();
    EXPECT_FALSE(pool.try_acquire());
    EXPECT_EQ(pool.in_use(), 2U);
    const Ref<const std::vector<int>> shared = std::move(a);
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): copying the handle is what is tested
    const Ref<const std::vector<int>> copy = shared;
    EXPECT_EQ(copy.get(), shared.get()) << "sharing does not copy";
  }
  EXPECT_EQ(pool.in_use(), 0U);
  EXPECT_EQ(pool.peak(), 2U);
  EXPECT_TRUE(pool.try_acquire());
  EXPECT_EQ(made, 2);
}
TEST(PoolDeathTest, running_dry_is_a_defect) {
  Pool<int> pool(1, [] { return 0; });
  const Ref<int> held = pool.acquire();
  EXPECT_DEATH((void)pool.acquire(), "pool exhausted");
}
TEST(PoolDeathTest, handle_that_outlives_its_pool_is_a_defect) {
  EXPECT_DEATH(
      {
        Ref<int> kept;
        const Pool<int> pool(1, [] { return 0; });
        kept = const_cast<Pool<int>&>(pool).acquire();
      },
      "outlives its pool");
}
TEST(Pool, stress_shared_objects_are_never_reused_while_held) {
  struct Cell {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
  };
  Pool<Cell> pool(6, [] { return Cell{}; });
  std::vector<std::jthread> threads;
  for (std::uint64_t t = 1; t <= 3; ++t) {
    threads.emplace_back([&pool, t] {
      for (std::uint64_t i = 0; i < 3'000; ++i) {
        Ref<Cell> mine = pool.acquire();  // 3 threads hold at most 2 each
        mine->a = t * 1'000'000 + i;
        mine->b = ~mine->a;
        const Ref<const Cell> shared = std::move(mine);
        // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): two handles on one object
        const Ref<const Cell> other = shared;
        ENAMEL_CHECK(shared->a == t * 1'000'000 + i && other->b == ~shared->a);
      }
    });
  }
  threads.clear();
  EXPECT_EQ(pool.in_use(), 0U);
}
TEST(Pool, stress_handles_are_released_by_other_threads) {
  Pool<std::uint64_t> pool(5, [] { return std::uint64_t{0}; });
  SpscRing<Ref<const std::uint64_t>> ring(4);
  constexpr std::uint64_t kItems = 10'000;
  std::jthread producer([&] {
    for (std::uint64_t i = 0; i < kItems;) {
      Ref<std::uint64_t> r = pool.try_acquire();
      if (!r || !ring.writable()) {
        std::this_thread::yield();
        continue;
      }
      *r = i++;
      ENAMEL_CHECK(ring.push(Ref<const std::uint64_t>(std::move(r))));
    }
  });
  for (std::uint64_t i = 0; i < kItems;) {
    if (auto* r = ring.front()) {
      ASSERT_EQ(**r, i++);
      ring.pop();
    } else {
      std::this_thread::yield();
    }
  }
}

}  // namespace
}  // namespace enamel
