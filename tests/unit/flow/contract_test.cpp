// R1 one in one out, R2 bounded waiting, R3 shared immutable payloads, R4 edge policies.
#include <gmock/gmock.h>

#include <set>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

using ::testing::HasSubstr;

template <class A, class B>
concept Connects = requires(Graph& g, Out<A>& out, In<B>& in) {
  g.connect(out, in);
};
static_assert(Connects<int, int>);
static_assert(!Connects<int, float>, "ports of different types must not connect");
static_assert(std::is_const_v<std::remove_reference_t<decltype(*std::declval<Item<int>&>())>>,
              "payloads are immutable");
static_assert(!std::is_copy_constructible_v<In<int>> && !std::is_move_constructible_v<Out<int>>);

class Contract : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InlineAndWorkers, Contract, ::testing::Values(0, 1, 3));

TEST_P(Contract, every_burst_arrives_once_in_order_with_its_reason) {
  ToyPipeline p(100);
  ASSERT_TRUE(run_with(GetParam(), p.graph));
  ASSERT_EQ(p.sink->items.size(), 100U);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(p.sink->items[i].id.value, i);
    EXPECT_EQ(to_ns(p.sink->items[i].captured), static_cast<std::int64_t>(i) * 1000);
    EXPECT_EQ(p.sink->items[i].ok(), i % 7 != 3);
    EXPECT_STREQ(p.sink->items[i].rejected, i % 7 == 3 ? "low_modulation" : nullptr);
  }
  const GraphSnapshot s = p.graph.snapshot();
  EXPECT_EQ(stage_of(s, "decode").in, 100U);
  EXPECT_EQ(stage_of(s, "decode").out, 100U);
  EXPECT_THAT(stage_of(s, "decode").rejected, ::testing::ElementsAre(std::make_pair("low_modulation", 14)));
  EXPECT_TRUE(stage_of(s, "register").rejected.empty()) << "a reason is counted where it arose, not where it passed";
  EXPECT_EQ(stage_of(s, "register").in, 100U);
  EXPECT_EQ(stage_of(s, "register").discarded, 0U);
}

/// Breaks the contract at burst 5 in a chosen way.
enum class Fault { kFilter, kEmitTwice, kOtherId, kTakeNothing };
class FaultyStage final : public Stage {
 public:
  explicit FaultyStage(Fault fault) : Stage("faulty"), fault_(fault) {}
  In<Number> in{*this, "in"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<void> step() override {
    const bool now = ++steps_ == 6;
    if (now && fault_ == Fault::kTakeNothing) {
      out.emit(make_item<Number>(ItemHead{.id = BurstId{5}}, 0));
      return {};
    }
    Item<Number> item = in.take();
    if (now && fault_ == Fault::kFilter) return {};
    if (now && fault_ == Fault::kEmitTwice) out.emit(item);
    if (now && fault_ == Fault::kOtherId) item.id.value += 1;
    out.emit(item);
    return {};
  }

 private:
  Fault fault_;
  int steps_ = 0;
};

Result<void> run_faulty(std::size_t workers, Fault fault, std::size_t* arrived = nullptr) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 1000);
  auto& faulty = g.add<FaultyStage>(fault);
  auto& side = g.add<MapStage>("side", [](const Item<Number>& i) { return i; });
  auto& sink = g.add<CollectSink>("sink");
  auto& other = g.add<CollectSink>("other");
  g.connect(source.out, faulty.in);
  g.connect(source.out, side.in);
  g.connect(faulty.out, sink.in);
  g.connect(side.out, other.in);
  Result<void> r = run_with(workers, g);
  if (arrived != nullptr) *arrived = sink.items.size();
  return r;
}

TEST_P(Contract, silent_filter_is_reported_instead_of_a_deadlock) {
  std::size_t arrived = 0;
  const auto r = run_faulty(GetParam(), Fault::kFilter, &arrived);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, ErrorCode::kInternal);
  EXPECT_THAT(r.error().detail, HasSubstr("stage 'faulty' emitted 0 items on 'out' for burst 5"));
  EXPECT_EQ(arrived, 5U) << "what was right before is delivered";
}
TEST_P(Contract, second_emission_is_reported) {
  const auto r = run_faulty(GetParam(), Fault::kEmitTwice);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().detail, HasSubstr("emitted 2 items on 'out'"));
}
TEST_P(Contract, item_of_another_burst_is_reported) {
  const auto r = run_faulty(GetParam(), Fault::kOtherId);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().detail, HasSubstr("emitted burst 6 on 'out' for burst 5"));
}
TEST_P(Contract, input_not_taken_is_reported) {
  const auto r = run_faulty(GetParam(), Fault::kTakeNothing);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().detail, HasSubstr("took 0 items from 'in'"));
}

class BackwardSource final : public Source {
 public:
  BackwardSource() : Source("backward") {}
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<Pull> pull() override {
    out.emit(make_item<Number>(ItemHead{.id = BurstId{10 - steps_++}}, 1));
    return Pull::kItem;
  }

 private:
  Number steps_ = 0;
};
TEST_P(Contract, source_whose_ids_do_not_increase_is_reported) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<BackwardSource>();
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, sink.in);
  const auto r = run_with(GetParam(), g);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().detail, HasSubstr("ids that do not increase"));
}

TEST_P(Contract, bounded_edges_hold_the_source_back) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 200);
  auto& pass = g.add<MapStage>("pass", [](const Item<Number>& i) { return i; });
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, pass.in, {.capacity = 3});
  g.connect(pass.out, sink.in, {.capacity = 1});
  Number worst = 0;
  sink.on_item = [&](const Item<Number>& i) {
    random_work(1, i.id.value);
    worst = std::max(worst, source.pulled.load() - i.id.value);
  };
  ASSERT_TRUE(run_with(GetParam(), g));
  EXPECT_LE(worst, 3U + 1U + 3U) << "edges hold 4, each stage at most one more";
  const GraphSnapshot s = g.snapshot();
  EXPECT_LE(s.edges[0].high_water, 3);
  EXPECT_LE(s.edges[1].high_water, 1);
  EXPECT_EQ(s.edges[0].pushed, 200U);
  EXPECT_EQ(s.edges[0].popped, 200U);
  EXPECT_EQ(s.edges[0].dropped, 0U);
}

TEST_P(Contract, fan_out_shares_the_payload) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 20);
  auto& a = g.add<CollectSink>("a");
  auto& b = g.add<CollectSink>("b");
  g.connect(source.out, a.in);
  g.connect(source.out, b.in);
  ASSERT_TRUE(run_with(GetParam(), g));
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(a.items[i].value.get(), b.items[i].value.get());
}

TEST_P(Contract, keep_latest_drops_counts_and_delivers_the_last_item) {
  ToyPipeline p(300);
  p.viewer->on_item = [](const Item<Number>& i) { random_work(20, i.id.value); };
  ASSERT_TRUE(run_with(GetParam(), p.graph));
  ASSERT_FALSE(p.viewer->items.empty());
  EXPECT_EQ(p.viewer->items.back().id.value, 299U);
  for (std::size_t i = 1; i < p.viewer->items.size(); ++i) {
    EXPECT_LT(p.viewer->items[i - 1].id, p.viewer->items[i].id);
  }
  const EdgeSnapshot e = p.graph.snapshot().edges.back();
  EXPECT_EQ(e.name, "fuse.out -> viewer.in");
  EXPECT_EQ(e.pushed, 300U);
  EXPECT_EQ(e.popped + e.dropped, 300U);
  EXPECT_EQ(e.popped, p.viewer->items.size());
}

TEST(KeepLatest, slow_viewer_loses_items_and_disturbs_nobody) {
  ToyPipeline reference(100);
  ASSERT_TRUE(run_with(0, reference.graph));
  ToyPipeline p(100);
  // The viewer sleeps on its first item until everybody else has finished.
  std::atomic<bool> finished{false};
  p.sink->on_stop = [&] {
    finished.store(true);
    finished.notify_all();
  };
  p.viewer->on_item = [&](const Item<Number>&) { finished.wait(false); };
  ASSERT_TRUE(run_with(2, p.graph));
  EXPECT_EQ(p.sink->hash(), reference.sink->hash());
  EXPECT_LE(p.viewer->items.size(), 3U);
  EXPECT_GE(p.graph.snapshot().edges.back().dropped, 97U);
}

TEST(Share, pooled_payloads_return_with_their_last_reader) {
  Pool<std::vector<int>> pool(2, [] { return std::vector<int>(10); });
  {
    Ref<std::vector<int>> r = pool.acquire();
    (*r)[0] = 7;
    const Item<std::vector<int>> item = make_item<std::vector<int>>(ItemHead{}, share<std::vector<int>>(std::move(r)));
    std::vector<Item<std::vector<int>>> readers(3, item);
    EXPECT_EQ((*readers.back())[0], 7);
    EXPECT_EQ(pool.in_use(), 1U);
  }
  EXPECT_EQ(pool.in_use(), 0U);
}

TEST(Tombstone, first_reason_is_kept) {
  const Item<int> first = make_rejected<int>(ItemHead{}, "dark");
  EXPECT_STREQ(make_rejected<float>(first, "later").rejected, "dark");
}

}  // namespace
}  // namespace enamel::flow
