// R5 feedback by a delay edge, R6 results independent of workers, replicas of a stateless stage.
#include <gtest/gtest.h>

#include "tests/unit/graph/toy_stages.hpp"

namespace enamel::graph {
namespace {

class Determinism : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InlineAndWorkers, Determinism, ::testing::Values(0, 1, 2, 3, 5));

TEST_P(Determinism, SameHashAsInline) {
  ToyPipeline reference(300);
  ASSERT_TRUE(run_with(0, reference.graph));
  for (int repeat = 0; repeat < 3; ++repeat) {
    ToyPipeline p(300);
    ASSERT_TRUE(run_with(GetParam(), p.graph));
    EXPECT_EQ(p.sink->hash(), reference.sink->hash());
  }
}

TEST_P(Determinism, FeedbackIsTheModelExactlyDelayBurstsAgo) {
  for (const std::size_t delay : {1U, 2U, 3U}) {
    ToyPipeline p(50, delay);
    ASSERT_TRUE(run_with(GetParam(), p.graph));
    // The sink has the model after each burst; register skips rejected bursts but takes their view all the same.
    Number model = 0;
    std::vector<Number> after;
    for (const auto& i : p.sink->items) after.push_back(model = i.ok() ? *i : model);
    std::size_t step = 0;
    for (std::size_t n = 0; n < 50; ++n) {
      if (n % 7 == 3) continue;
      EXPECT_EQ(p.reg->seen_models[step++], n < delay ? 0 : after[n - delay]) << "burst " << n << ", delay " << delay;
    }
    EXPECT_EQ(step, p.reg->seen_models.size());
  }
}

TEST(Delay, ChangesTheResult) {  // the hash does see the feedback
  ToyPipeline two(40, 2);
  ToyPipeline three(40, 3);
  ASSERT_TRUE(run_with(0, two.graph));
  ASSERT_TRUE(run_with(0, three.graph));
  EXPECT_NE(two.sink->hash(), three.sink->hash());
}

/// Two schedules, both legal: fusion of burst n is done before registration of n + 1 begins, or only after it began.
enum class Schedule { kFusionFirst, kRegistrationFirst };

void force(Schedule schedule, ToyPipeline& p, Number count) {
  auto registered = std::make_shared<std::atomic<Number>>(0);  // bursts that registration has begun
  auto fused = std::make_shared<std::atomic<Number>>(0);       // bursts that fusion has finished
  const auto wait_for = [](const std::atomic<Number>& a, Number at_least) {
    for (Number v = a.load(); v < at_least; v = a.load()) a.wait(v);
  };
  const auto note = [](std::atomic<Number>& a, Number value) {
    a.store(value);
    a.notify_all();
  };
  p.reg->before = [=](Number n) {
    if (schedule == Schedule::kFusionFirst) wait_for(*fused, n);
  };
  auto inner = p.reg->before;
  p.reg->before = [=](Number n) {
    inner(n);
    note(*registered, n + 1);
  };
  p.fuse->before = [=](Number n) {
    if (schedule == Schedule::kRegistrationFirst && n + 1 < count) wait_for(*registered, n + 2);
  };
  p.fuse->after = [=](Number n) { note(*fused, n + 1); };
}

/// Every burst is accepted here, so that registration sees each of them.
std::string hash_under(Schedule schedule, bool latest_model) {
  constexpr Number kCount = 60;
  SteadyClock clock;
  ToyPipeline p(0);  // stages for a second graph
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", kCount);
  auto& reg = g.add<RegisterStage>("register");
  auto& fuse = g.add<FuseStage>("fuse");
  auto& sink = g.add<CollectSink>("sink");
  p.reg = &reg;
  p.fuse = &fuse;
  force(schedule, p, kCount);
  std::atomic<Number> latest{0};
  MapStage* spoil = nullptr;
  if (latest_model) {
    // Registration looks at the model as it happens to be.
    spoil =
        &g.add<MapStage>("look", [&latest](const Item<Number>& i) { return make_item<Number>(i, mix(*i, latest)); });
    auto before = reg.before;
    reg.before = nullptr;
    auto fn = [before, &latest](const Item<Number>& i) {
      before(i.id.value);
      return make_item<Number>(i, mix(*i, latest.load()));
    };
    auto& look = g.add<MapStage>("look_now", fn);
    g.connect(source.out, spoil->in);
    g.connect(spoil->out, look.in);
    g.connect(look.out, reg.in);
    auto after = fuse.after;
    fuse.after = [after, &latest](Number n) {
      latest.store(mix(n, 77));
      after(n);
    };
  } else {
    g.connect(source.out, reg.in);
  }
  g.connect(reg.out, fuse.in);
  g.connect_feedback(fuse.view, reg.model, 2, make_rejected<Number>({}, "no_model"));
  g.connect(fuse.out, sink.in);
  EXPECT_TRUE(WorkerExecutor(3).run(g));
  EXPECT_EQ(sink.items.size(), kCount);
  return sink.hash();
}

TEST(Schedule, DelayEdgeGivesOneHash) {
  EXPECT_EQ(hash_under(Schedule::kFusionFirst, false), hash_under(Schedule::kRegistrationFirst, false));
}
TEST(Schedule, LatestModelGivesAnotherHashForEachSchedule) {  // negative control: the gate sees it
  EXPECT_NE(hash_under(Schedule::kFusionFirst, true), hash_under(Schedule::kRegistrationFirst, true));
}

std::string hash_with_replicas(std::size_t replicas, std::size_t workers) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 200);
  auto& sink = g.add<CollectSink>("sink");
  std::vector<In<Number>*> ins;
  std::vector<Out<Number>*> outs;
  for (std::size_t i = 0; i < replicas; ++i) {
    auto& r = g.add<MapStage>("decode " + std::to_string(i), [](const Item<Number>& item) {
      random_pause(3, item.id.value);
      return item.id.value % 5 == 0 ? make_rejected<Number>(item, "dark") : make_item<Number>(item, mix(9, *item));
    });
    ins.push_back(&r.in);
    outs.push_back(&r.out);
  }
  g.connect_split(source.out, std::span<In<Number>* const>(ins));
  g.connect_merge(std::span<Out<Number>* const>(outs), sink.in);
  EXPECT_TRUE(run_with(workers, g));
  EXPECT_EQ(sink.items.size(), 200U);
  for (std::size_t i = 0; i < sink.items.size(); ++i) EXPECT_EQ(sink.items[i].id.value, i);
  return sink.hash();
}
TEST_P(Determinism, ReplicasOfAStatelessStageKeepOrderAndResult) {
  const std::string one = hash_with_replicas(1, 0);
  EXPECT_EQ(hash_with_replicas(2, GetParam()), one);
  EXPECT_EQ(hash_with_replicas(3, GetParam()), one);
}

}  // namespace
}  // namespace enamel::graph
