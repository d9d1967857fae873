// R5 feedback by a delay edge, R6 results independent of workers, replicas of a stateless stage.
#include <gtest/gtest.h>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

class Determinism : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InlineAndWorkers, Determinism, ::testing::Values(0, 1, 2, 3, 5));

TEST_P(Determinism, same_hash_as_inline) {
  ToyPipeline reference(300);
  ASSERT_TRUE(run_with(0, reference.graph));
  for (int repeat = 0; repeat < 3; ++repeat) {
    ToyPipeline p(300);
    ASSERT_TRUE(run_with(GetParam(), p.graph));
    EXPECT_EQ(p.sink->hash(), reference.sink->hash());
  }
}

TEST_P(Determinism, feedback_is_the_model_exactly_delay_bursts_ago) {
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

TEST(Delay, changes_the_result) {  // the hash does see the feedback
  ToyPipeline two(40, 2);
  ToyPipeline three(40, 3);
  ASSERT_TRUE(run_with(0, two.graph));
  ASSERT_TRUE(run_with(0, three.graph));
  EXPECT_NE(two.sink->hash(), three.sink->hash());
}

/// Two schedules, both legal: fusion of burst n is done before registration of n + 1 begins, or ends only after it
/// began.
enum class Schedule { kFusionFirst, kRegistrationFirst };

/// Makes registration and fusion wait for each other: what no stage may do, here to force a schedule that chance could
/// bring.
class Turnstile {
 public:
  Turnstile(Schedule schedule, Number count) : schedule_(schedule), count_(count) {}
  void registration_begins(Number n) {
    if (schedule_ == Schedule::kFusionFirst) wait_for(fused_, n);
    note(registered_, n + 1);
  }
  void fusion_begins(Number n) {
    if (schedule_ == Schedule::kRegistrationFirst && n + 1 < count_) wait_for(registered_, n + 2);
  }
  void fusion_ended(Number n) { note(fused_, n + 1); }

 private:
  static void wait_for(const std::atomic<Number>& a, Number at_least) {
    for (Number v = a.load(); v < at_least; v = a.load()) a.wait(v);
  }
  static void note(std::atomic<Number>& a, Number value) {
    a.store(value);
    a.notify_all();
  }
  Schedule schedule_;
  Number count_;
  std::atomic<Number> registered_{0};
  std::atomic<Number> fused_{0};
};

/// With `latest_model`, registration also looks at the model as it happens to be, past the delay edge.
std::string hash_under(Schedule schedule, bool latest_model) {
  constexpr Number kCount = 60;
  Turnstile turn(schedule, kCount);
  std::atomic<Number> latest{0};
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", kCount);
  auto& look = g.add<MapStage>("look", [&](const Item<Number>& i) {
    turn.registration_begins(i.id.value);
    return make_item<Number>(i, latest_model ? mix(*i, latest.load()) : *i);
  });
  auto& reg = g.add<RegisterStage>("register");
  auto& fuse = g.add<FuseStage>("fuse");
  auto& sink = g.add<CollectSink>("sink");
  fuse.before = [&](Number n) { turn.fusion_begins(n); };
  fuse.after = [&](Number n) {
    latest.store(n + 1);
    turn.fusion_ended(n);
  };
  g.connect(source.out, look.in);
  g.connect(look.out, reg.in);
  g.connect(reg.out, fuse.in);
  g.connect_feedback(fuse.view, reg.model, 2, make_rejected<Number>({}, "no_model"));
  g.connect(fuse.out, sink.in);
  EXPECT_TRUE(WorkerExecutor(3).run(g));
  EXPECT_EQ(sink.items.size(), kCount);
  return sink.hash();
}

TEST(Schedule, delay_edge_gives_one_hash) {
  EXPECT_EQ(hash_under(Schedule::kFusionFirst, false), hash_under(Schedule::kRegistrationFirst, false));
}
TEST(Schedule, latest_model_gives_another_hash_for_each_schedule) {  // negative control: the gate sees it
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
      random_work(3, item.id.value);
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
TEST_P(Determinism, replicas_of_a_stateless_stage_keep_order_and_result) {
  const std::string one = hash_with_replicas(1, 0);
  EXPECT_EQ(hash_with_replicas(2, GetParam()), one);
  EXPECT_EQ(hash_with_replicas(3, GetParam()), one);
}

/// Decoders that each need what came of the burst six before.
std::string hash_with_taught_replicas(std::size_t replicas, std::size_t workers) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 200);
  auto& learn = g.add<FuseStage>("learn");
  auto& sink = g.add<CollectSink>("sink");
  std::vector<In<Number>*> ins, taught;
  std::vector<Out<Number>*> outs;
  for (std::size_t i = 0; i < replicas; ++i) {
    auto& r = g.add<RegisterStage>("decode " + std::to_string(i));
    ins.push_back(&r.in), taught.push_back(&r.model), outs.push_back(&r.out);
  }
  g.connect_split(source.out, std::span<In<Number>* const>(ins));
  g.connect_merge(std::span<Out<Number>* const>(outs), learn.in);
  g.connect_feedback_split(learn.view, std::span<In<Number>* const>(taught), 6, make_item<Number>({}, Number{7}));
  g.connect(learn.out, sink.in);
  EXPECT_TRUE(run_with(workers, g));
  EXPECT_EQ(sink.items.size(), 200U);
  return sink.hash();
}
TEST_P(Determinism, replicas_taught_by_a_delay_edge_give_the_result_of_one) {
  const std::string one = hash_with_taught_replicas(1, 0);
  EXPECT_EQ(hash_with_taught_replicas(2, GetParam()), one);
  EXPECT_EQ(hash_with_taught_replicas(3, GetParam()), one);
}

}  // namespace
}  // namespace enamel::flow
