// R7 stop and end in order, R8 failures, live sources and their wakers.
#include <gmock/gmock.h>

#include <deque>
#include <mutex>
#include <thread>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Lifecycle : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InlineAndWorkers, Lifecycle, ::testing::Values(0, 1, 3));

TEST_P(Lifecycle, stop_drains_what_is_under_way_and_stops_stages_in_order) {
  const SteadyClock clock;
  Graph g(clock);
  std::stop_source stop;
  auto& source = g.add<CountingSource>("source", ~Number{0});  // endless
  auto& pass = g.add<MapStage>("pass", [](const Item<Number>& i) { return i; });
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, pass.in);
  g.connect(pass.out, sink.in);
  std::mutex mutex;
  std::vector<std::string> stopped;
  const auto note = [&](const char* name) {
    const std::lock_guard lock(mutex);
    stopped.emplace_back(name);
  };
  source.on_stop = [&] { note("source"); };
  pass.on_stop = [&] { note("pass"); };
  sink.on_stop = [&] { note("sink"); };
  sink.on_item = [&](const Item<Number>& i) {
    if (i.id.value == 20) stop.request_stop();
  };
  ASSERT_TRUE(run_with(GetParam(), g, stop.get_token()));
  EXPECT_EQ(sink.items.size(), source.pulled.load()) << "every burst that entered came out";
  EXPECT_THAT(stopped, ElementsAre("source", "pass", "sink"));
  EXPECT_EQ(stage_of(g.snapshot(), "sink").state, StageState::kDone);
}

TEST_P(Lifecycle, stop_before_the_start_runs_nothing) {
  ToyPipeline p(10);
  std::stop_source stop;
  stop.request_stop();
  ASSERT_TRUE(run_with(GetParam(), p.graph, stop.get_token()));
  EXPECT_EQ(p.source->pulled.load(), 0U);
}

/// What a network thread fills: the lock is the test's, the graph's side only takes it inside pull().
class LiveSource final : public Source {
 public:
  LiveSource() : Source("live") {}
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<Pull> pull() override {
    ++pulls;
    const std::lock_guard lock(mutex);
    if (queue.empty()) return closed ? Pull::kEnd : Pull::kNotYet;
    out.emit(make_item<Number>(ItemHead{.id = BurstId{queue.front()}}, queue.front()));
    queue.pop_front();
    return Pull::kItem;
  }
  std::atomic<Number> pulls{0};
  std::mutex mutex;
  std::deque<Number> queue;
  bool closed = false;
};

TEST_P(Lifecycle, notifications_from_another_thread_are_never_lost) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<LiveSource>();
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, sink.in);
  constexpr Number kItems = 500;
  std::jthread feeder([&source, waker = g.waker()] {
    for (Number i = 0; i <= kItems; ++i) {
      {
        const std::lock_guard lock(source.mutex);
        if (i < kItems) source.queue.push_back(i);
        source.closed = i == kItems;
      }
      waker.notify();
      random_work(4, i);
    }
  });
  ASSERT_TRUE(run_with(GetParam(), g));
  EXPECT_EQ(sink.items.size(), kItems);
}

TEST_P(Lifecycle, parked_source_is_not_polled_and_stop_wakes_it) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<LiveSource>();
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, sink.in);
  std::stop_source stop;
  const Waker waker = g.waker();
  std::jthread other([&] {
    while (source.pulls.load() < 1) std::this_thread::yield();
    waker.notify();
    while (source.pulls.load() < 2) std::this_thread::yield();
    for (Number i = 0; i < 50; ++i) random_work(6, i);  // time to poll, for one who would
    stop.request_stop();
  });
  ASSERT_TRUE(run_with(GetParam(), g, stop.get_token()));
  EXPECT_EQ(source.pulls.load(), 2U) << "once at the start, once for the notification";
}

TEST(Waker, may_outlive_its_graph) {
  const SteadyClock clock;
  auto g = std::make_unique<Graph>(clock);
  const Waker waker = g->waker();
  g.reset();
  waker.notify();
}

/// Fails at burst 5.
class FailingStage final : public Stage {
 public:
  FailingStage(OnError action, bool throws) : Stage("failing"), action_(action), throws_(throws) {}
  In<Number> in{*this, "in"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<void> step() override {
    const Item<Number> item = in.take();
    if (item.id.value == 5 && throws_) throw std::runtime_error("out of luck");
    if (item.id.value == 5) return fail(ErrorCode::kHal, "gone");
    out.emit(item);
    return {};
  }
  [[nodiscard]] OnError on_error(const Error&) noexcept override { return action_; }
  void stop() noexcept override { ++stops; }
  int stops = 0;

 private:
  OnError action_;
  bool throws_;
};

struct FailingRun {
  FailingRun(std::size_t workers, OnError action, bool throws = false) : graph(clock) {
    auto& source = graph.add<CountingSource>("source", 200);
    auto& stage = graph.add<FailingStage>(action, throws);
    sink = &graph.add<CollectSink>("sink");
    sink->on_stop = [this] { ++sink_stops; };
    graph.connect(source.out, stage.in);
    graph.connect(stage.out, sink->in);
    result = run_with(workers, graph);
    stage_stops = stage.stops;
  }
  SteadyClock clock;
  Graph graph;
  CollectSink* sink = nullptr;
  int stage_stops = 0;
  int sink_stops = 0;
  Result<void> result;
};

TEST_P(Lifecycle, fatal_error_ends_the_run_and_closes_every_stage) {
  const FailingRun r(GetParam(), OnError::kFatal);
  ASSERT_FALSE(r.result);
  EXPECT_EQ(r.result.error().code, ErrorCode::kHal);
  EXPECT_EQ(r.sink->items.size(), 5U) << "bursts before the failure arrive";
  EXPECT_EQ(r.stage_stops, 1);
  EXPECT_EQ(r.sink_stops, 1);
  EXPECT_EQ(stage_of(r.graph.snapshot(), "failing").errors, 1U);
}
TEST_P(Lifecycle, skipped_error_becomes_a_tombstone) {
  const FailingRun r(GetParam(), OnError::kSkip);
  ASSERT_TRUE(r.result);
  ASSERT_EQ(r.sink->items.size(), 200U);
  EXPECT_STREQ(r.sink->items[5].rejected, "stage_error");
  EXPECT_FALSE(r.sink->items[6].degraded);
  EXPECT_THAT(stage_of(r.graph.snapshot(), "failing").rejected, ElementsAre(std::make_pair("stage_error", 1)));
}
TEST_P(Lifecycle, degraded_stage_marks_everything_after) {
  const FailingRun r(GetParam(), OnError::kDegrade);
  ASSERT_TRUE(r.result);
  EXPECT_FALSE(r.sink->items[4].degraded);
  EXPECT_FALSE(r.sink->items[5].ok());
  EXPECT_TRUE(r.sink->items[6].degraded);
  EXPECT_TRUE(r.sink->items[6].ok());
  EXPECT_EQ(stage_of(r.graph.snapshot(), "failing").degraded, 194U);
}
TEST_P(Lifecycle, exception_is_an_error_that_names_the_stage) {
  const FailingRun r(GetParam(), OnError::kFatal, true);
  ASSERT_FALSE(r.result);
  EXPECT_EQ(r.result.error().code, ErrorCode::kInternal);
  EXPECT_THAT(r.result.error().detail, HasSubstr("stage 'failing' threw: out of luck"));
}
TEST_P(Lifecycle, fatal_error_inside_the_feedback_loop_does_not_hang) {
  ToyPipeline p(100);
  p.fuse->before = [](Number n) {
    if (n == 30) throw std::runtime_error("volume full");
  };
  const auto r = run_with(GetParam(), p.graph);
  ASSERT_FALSE(r);
  EXPECT_THAT(r.error().detail, HasSubstr("stage 'fuse' threw: volume full"));
  EXPECT_EQ(p.sink->items.size(), 30U);
}

class StartFails final : public Stage {
 public:
  StartFails() : Stage("second") {}
  In<Number> in{*this, "in"};
  [[nodiscard]] Result<void> start() override { return fail(ErrorCode::kFileWrite, "no disk"); }
  [[nodiscard]] Result<void> step() override { return {}; }
  void stop() noexcept override { ++stops; }
  int stops = 0;
};
TEST_P(Lifecycle, failed_start_stops_what_had_started) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 3);
  auto& second = g.add<StartFails>();
  int stops = 0;
  source.on_stop = [&] { ++stops; };
  g.connect(source.out, second.in);
  const auto r = run_with(GetParam(), g);
  ASSERT_FALSE(r);
  EXPECT_EQ(r.error().code, ErrorCode::kFileWrite);
  EXPECT_EQ(stops, 1);
  EXPECT_EQ(second.stops, 0);
  EXPECT_EQ(source.pulled.load(), 0U);
}

TEST(Run, graph_runs_once) {
  ToyPipeline p(3);
  ASSERT_TRUE(run_with(0, p.graph));
  EXPECT_THAT(run_with(0, p.graph).error().detail, HasSubstr("only once"));
}

}  // namespace
}  // namespace enamel::flow
