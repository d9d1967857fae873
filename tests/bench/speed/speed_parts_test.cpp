// What bench_speed measures with: counts that are right, and that can be wrong.
#include <gmock/gmock.h>

#include <cstdlib>
#include <thread>
#include <vector>

#include "pipeline/flow/executor.hpp"
#include "pipeline/flow/graph.hpp"
#include "tests/bench/speed/scan_cost.hpp"
#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::bench {
namespace {

/// Keeps the compiler from leaving an allocation out.
void* volatile kept = nullptr;

TEST(MallocCount, counts_blocks_and_bytes_however_they_are_asked_for) {
  const HeapUse before = heap_use();
  kept = std::malloc(100);
  std::free(kept);
  kept = std::calloc(3, 50);
  kept = std::realloc(kept, 200);
  std::free(kept);
  kept = std::aligned_alloc(64, 128);
  std::free(kept);
  kept = ::operator new(8);
  ::operator delete(kept);
  EXPECT_EQ(heap_use().blocks - before.blocks, 5U);
  EXPECT_EQ(heap_use().bytes - before.bytes, 100U + 150U + 200U + 128U + 8U);
}

TEST(MallocCount, counts_nothing_of_another_thread_and_nothing_where_nothing_is_asked_for) {
  std::vector<int> room(10);
  std::uint64_t there = 0;
  std::jthread other([&] {
    const HeapUse before = heap_use();
    kept = std::malloc(1);
    std::free(kept);
    there = heap_use().blocks - before.blocks;
  });
  const HeapUse before = heap_use();
  other.join();
  room.clear();
  room.push_back(1);
  EXPECT_EQ(heap_use().blocks, before.blocks);
  EXPECT_EQ(there, 1U);
}

TEST(InstructionCounter, twice_the_work_is_twice_the_instructions) {
  InstructionCounter counter;
  if (!counter.open()) GTEST_SKIP() << counter.problem();
  const auto cost_of = [&](int rounds) {
    volatile std::uint64_t sum = 0;
    const std::uint64_t before = counter.value();
    for (int i = 0; i < rounds; ++i) sum = sum + 1;
    return static_cast<double>(counter.value() - before);
  };
  const double once = cost_of(1000000);
  EXPECT_GT(once, 1e6);
  EXPECT_NEAR(cost_of(2000000) / once, 2, 0.02);
}

TEST(InstructionCounter, says_why_there_is_none) {
  InstructionCounter never_opened;
  EXPECT_EQ(never_opened.value(), 0U);
  EXPECT_THAT(never_opened.problem(), ::testing::HasSubstr("no instruction counter"));
}

StepCost cost(std::uint64_t instructions, double ms, std::uint64_t blocks) {
  StepCost c;
  c.instructions = instructions;
  c.core_ms = ms;
  c.heap = {blocks, 1024 * blocks};
  return c;
}

TEST(Summary, takes_of_each_burst_the_least_of_the_repeats_and_blocks_of_the_second_half) {
  const std::vector<StepCost> first{cost(10, 1, 90), cost(20, 9, 90), cost(30, 3, 4), cost(40, 4, 6)};
  const std::vector<StepCost> second{cost(12, 5, 90), cost(20, 2, 90), cost(29, 8, 4), cost(41, 4, 6)};
  const StageCost s = summarise({first, second});
  EXPECT_EQ(s.bursts, 4U);
  EXPECT_DOUBLE_EQ(s.instructions, (10 + 20 + 29 + 40) / 4.0);
  EXPECT_DOUBLE_EQ(s.mean_ms, (1 + 2 + 3 + 4) / 4.0);
  EXPECT_DOUBLE_EQ(s.p50_ms, 2);
  EXPECT_DOUBLE_EQ(s.p99_ms, 4);
  EXPECT_DOUBLE_EQ(s.blocks, 5);
  EXPECT_DOUBLE_EQ(s.kib, 5);
}

TEST(Meter, gives_a_stage_the_blocks_that_it_asked_for_and_another_none) {
  const SteadyClock clock;
  flow::Graph graph(clock);
  auto& source = graph.add<flow::CountingSource>("source", 20);
  auto& greedy = graph.add<flow::MapStage>("greedy", [](const flow::Item<flow::Number>& item) {
    for (int i = 0; i < 7; ++i) {
      kept = std::malloc(64);
      std::free(kept);
    }
    return item;
  });
  auto& modest = graph.add<flow::MapStage>("modest", [](const flow::Item<flow::Number>& item) { return item; });
  auto& sink = graph.add<flow::CollectSink>("sink");
  graph.connect(source.out, greedy.in);
  graph.connect(greedy.out, modest.in);
  graph.connect(modest.out, sink.in);
  StepMeter meter(100);
  graph.observe(&meter);
  ASSERT_TRUE(flow::InlineExecutor().run(graph));
  const auto costs = meter.by_stage();
  ASSERT_EQ(costs.at("greedy").size(), 20U);
  EXPECT_EQ(costs.at("source").size(), 20U) << "the pull that brings nothing is no burst";
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(costs.at("greedy")[i].burst, i);
    EXPECT_EQ(costs.at("greedy")[i].heap.blocks, 7U);
    EXPECT_EQ(costs.at("modest")[i].heap.blocks, 0U);
  }
}

TEST(Ageing, a_stage_that_takes_longer_the_more_bursts_there_were_is_told) {
  const auto ageing_with = [](double growth) {
    std::vector<StepCost> costs(80);
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const double work = (1 + growth * static_cast<double>(i) / 80) * (1 + 0.05 * static_cast<double>(i % 7));
      costs[i] = {.burst = i, .instructions = static_cast<std::uint64_t>(1e8 * work), .core_ms = 20 * work, .heap = {}};
    }
    return summarise({costs}).ageing;
  };
  EXPECT_NEAR(ageing_with(0).instructions, 1, 0.01);
  EXPECT_NEAR(ageing_with(0).ms, 1, 0.01);
  EXPECT_GT(ageing_with(0.6).instructions, 1.2) << "control";
  EXPECT_EQ(summarise({std::vector<StepCost>(3)}).ageing.ms, 0) << "too few to say";
}

TEST(ThereAndBack, bursts_follow_each_other_and_none_is_twice_the_same) {
  Recording recording;
  for (std::uint64_t n = 0; n < 4; ++n) {
    auto burst = std::make_shared<proto::Burst>();
    burst->t_first_exposure_ns = 5000 + 100 * n;
    burst->payload = {static_cast<std::uint8_t>(10 * n), 1, 2, 3};
    for (std::uint32_t k = 0; k < 4; ++k)
      burst->meta.push_back({.t_strobe_ns = 5000 + 100 * n + 7 * k, .offset = k, .length = 1});
    recording.bursts.push_back({.id = BurstId{n}, .burst = std::move(burst)});
  }
  const Recording out = there_and_back(recording, 3);
  std::vector<int> order;
  for (std::size_t n = 0; n < out.bursts.size(); ++n) {
    const proto::Burst& burst = *out.bursts[n].burst;
    order.push_back(burst.payload[0] / 10);
    EXPECT_EQ(burst.burst_index, n);
    EXPECT_EQ(burst.t_first_exposure_ns, 5000 + 100 * n);
    EXPECT_EQ(burst.meta[3].t_strobe_ns, 5000 + 100 * n + 21);
    for (std::size_t before = n >= 2 ? n - 2 : 0; before < n; ++before)
      EXPECT_NE(burst.payload, out.bursts[before].burst->payload);
  }
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3, 2, 1, 0, 1, 2, 3));
}

}  // namespace
}  // namespace enamel::bench
