// What validate() refuses, what a graph counts.
#include <gmock/gmock.h>

#include <array>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

using ::testing::HasSubstr;

Item<Number> same(const Item<Number>& i) { return i; }

class Join final : public Stage {
 public:
  explicit Join(std::string name) : Stage(std::move(name)) {}
  In<Number> a{*this, "a"};
  In<Number> b{*this, "b"};
  Out<Number> out{*this, "out"};
  [[nodiscard]] Result<void> step() override {
    const Item<Number> x = a.take();
    const Item<Number> y = b.take();
    out.emit(make_item<Number>(x, *x + *y));
    return {};
  }
};

struct Built {
  SteadyClock clock;
  Graph g{clock};
  CountingSource& source = g.add<CountingSource>("source", 10);
  CollectSink& sink = g.add<CollectSink>("sink");
  void expect_refused(const std::string& part) {
    const auto r = g.validate();
    ASSERT_FALSE(r);
    EXPECT_EQ(r.error().code, ErrorCode::kInternal);
    EXPECT_THAT(r.error().detail, HasSubstr(part));
    EXPECT_FALSE(run_with(0, g)) << "and it does not run";
  }
};

TEST(Validate, accepts_the_toy_pipeline) { EXPECT_TRUE(ToyPipeline(1).graph.validate()); }
TEST(Validate, refuses_unconnected_input) {
  Built b;
  b.source.out.ignore();
  b.expect_refused("input 'sink.in' is not connected");
}
TEST(Validate, refuses_unconnected_output_unless_ignored) {
  Built b;
  auto& pass = b.g.add<MapStage>("pass", same);
  b.g.connect(b.source.out, pass.in);
  b.g.connect(b.source.out, b.sink.in);
  EXPECT_THAT(b.g.validate().error().detail, HasSubstr("output 'pass.out' is not connected"));
  pass.out.ignore();
  ASSERT_TRUE(b.g.validate());
  EXPECT_TRUE(run_with(0, b.g));
  EXPECT_EQ(b.sink.items.size(), 10U);
}
TEST(Validate, refuses_an_input_connected_twice) {
  Built b;
  b.g.connect(b.source.out, b.sink.in);
  b.g.connect(b.source.out, b.sink.in);
  b.expect_refused("connected twice");
}
TEST(Validate, refuses_two_stages_of_one_name) {
  Built b;
  auto& pass = b.g.add<MapStage>("sink", same);
  b.g.connect(b.source.out, pass.in);
  b.g.connect(pass.out, b.sink.in);
  b.expect_refused("two stages are named 'sink'");
}
TEST(Validate, refuses_no_capacity_and_no_delay) {
  Built b;
  b.g.connect(b.source.out, b.sink.in, {.capacity = 0});
  b.expect_refused("has no capacity");
  ToyPipeline p(1, 0);
  EXPECT_THAT(p.graph.validate().error().detail, HasSubstr("delay of at least 1"));
}
TEST(Validate, refuses_a_delay_that_replicas_do_not_share_out_evenly) {
  const auto verdict = [](std::size_t delay) {
    const SteadyClock clock;
    Graph g(clock);
    auto& source = g.add<CountingSource>("source", 1);
    auto& learn = g.add<FuseStage>("learn");
    auto& sink = g.add<CollectSink>("sink");
    RegisterStage &a = g.add<RegisterStage>("a"), &b = g.add<RegisterStage>("b");
    const std::array<In<Number>*, 2> ins{&a.in, &b.in}, taught{&a.model, &b.model};
    const std::array<Out<Number>*, 2> outs{&a.out, &b.out};
    g.connect_split<Number>(source.out, ins);
    g.connect_merge<Number>(outs, learn.in);
    g.connect_feedback_split<Number>(learn.view, taught, delay, make_item<Number>({}, Number{0}));
    g.connect(learn.out, sink.in);
    return g.validate();
  };
  EXPECT_TRUE(verdict(4)) << "negative control";
  EXPECT_THAT(verdict(3).error().detail, HasSubstr("'a.model' needs a delay that is a multiple of its replicas"));
  EXPECT_THAT(verdict(0).error().detail, HasSubstr("delay of at least 1"));
}

TEST(Validate, refuses_a_cycle_without_delay) {
  Built b;
  auto& join = b.g.add<Join>("join");
  auto& back = b.g.add<MapStage>("back", same);
  b.g.connect(b.source.out, join.a);
  b.g.connect(back.out, join.b);
  b.g.connect(join.out, back.in);
  b.g.connect(join.out, b.sink.in);
  b.expect_refused("cycle without a delay edge");
}
TEST(Validate, refuses_a_join_of_two_sources) {
  Built b;
  auto& second = b.g.add<CountingSource>("second", 10);
  auto& join = b.g.add<Join>("join");
  b.g.connect(b.source.out, join.a);
  b.g.connect(second.out, join.b);
  b.g.connect(join.out, b.sink.in);
  b.expect_refused("stage 'join' joins paths of different sources or losses");
}
TEST(Validate, refuses_a_lossy_path_into_a_lossless_join) {
  Built b;
  auto& join = b.g.add<Join>("join");
  b.g.connect(b.source.out, join.a);
  b.g.connect(b.source.out, join.b, {.on_full = OnFull::kKeepLatest});
  b.g.connect(join.out, b.sink.in);
  b.expect_refused("different sources or losses");
}
TEST(Validate, refuses_feedback_from_a_lossy_path) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 10);
  auto& reg = g.add<RegisterStage>("register");
  auto& view = g.add<MapStage>("view", same);
  g.connect(source.out, reg.in);
  g.connect(reg.out, view.in, {.on_full = OnFull::kKeepLatest});
  g.connect_feedback(view.out, reg.model, 2, make_rejected<Number>({}, "none"));
  EXPECT_THAT(g.validate().error().detail, HasSubstr("feedback into 'register.model' comes from a path of another"));
}
TEST(Validate, refuses_a_stage_that_only_feedback_paces) {
  const SteadyClock clock;
  Graph g(clock);
  auto& pass = g.add<MapStage>("self", same);
  g.connect_feedback(pass.out, pass.in, 1, make_rejected<Number>({}, "none"));
  EXPECT_THAT(g.validate().error().detail, HasSubstr("nothing paces it"));
}

TEST(Metrics, service_time_comes_from_the_injected_clock) {
  ManualClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 20);
  auto& slow = g.add<MapStage>("slow", [&clock](const Item<Number>& i) {
    clock.advance(Nanoseconds{i.id.value == 19 ? 1000 : 10});
    return i;
  });
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, slow.in);
  g.connect(slow.out, sink.in);
  ASSERT_TRUE(run_with(0, g));
  const GraphSnapshot s = g.snapshot();
  EXPECT_EQ(stage_of(s, "slow").service_ns.count, 20U);
  EXPECT_EQ(stage_of(s, "slow").service_ns.p50, 10);
  EXPECT_EQ(stage_of(s, "slow").service_ns.max, 1000);
  EXPECT_EQ(stage_of(s, "sink").service_ns.max, 0);
}

TEST(Metrics, json_holds_stages_and_edges) {
  ToyPipeline p(30);
  ASSERT_TRUE(run_with(2, p.graph));
  const auto j = nlohmann::json::parse(to_json(p.graph.snapshot()));
  EXPECT_EQ(j.at("stages").size(), 6U);
  EXPECT_EQ(j.at("stages")[1].at("rejected").at("low_modulation"), 4);
  EXPECT_EQ(j.at("stages")[1].at("state"), "done");
  EXPECT_EQ(j.at("edges")[3].at("name"), "fuse.view -> register.model");
  EXPECT_EQ(j.at("edges")[0].at("pushed"), 30);
}

TEST(Metrics, snapshots_may_be_taken_while_the_graph_runs) {
  ToyPipeline p(300);
  std::atomic<bool> done{false};
  Number snapshots = 0;
  std::jthread watcher([&] {
    for (; !done.load(); ++snapshots) {
      const GraphSnapshot s = p.graph.snapshot();
      ENAMEL_CHECK(stage_of(s, "sink").in <= 300);
    }
  });
  ASSERT_TRUE(run_with(2, p.graph));
  done.store(true);
  watcher.join();
  EXPECT_GT(snapshots, 0U);
}

TEST(RejectCounters, reasons_beyond_the_table_count_as_other) {
  std::vector<std::string> names(20);
  RejectCounters c;
  for (std::size_t i = 0; i < names.size(); ++i) c.add((names[i] = "reason " + std::to_string(i)).c_str());
  const auto s = c.snapshot();
  ASSERT_EQ(s.size(), 16U);
  EXPECT_EQ(s.back(), (std::pair<std::string, std::uint64_t>("other", 5)));
}

}  // namespace
}  // namespace enamel::flow
