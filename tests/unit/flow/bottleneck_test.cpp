// Which stage sets the rate: from constructed snapshots, and from graphs whose clock the stages turn.
#include "pipeline/flow/bottleneck.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

StageSnapshot stage(const std::string& name, const StageTimes& times) {
  StageSnapshot s;
  s.name = s.family = name;
  s.is_source = name == "source";
  s.out = 100;
  s.time_ns = times;
  return s;
}

EdgeSnapshot edge(const std::string& from, const std::string& to, std::int64_t awaited_ns, std::int64_t blocked_ns) {
  EdgeSnapshot e{.name = {}, .from = from, .to = to, .capacity = 2};
  e.awaited_ns = awaited_ns;
  e.blocked_ns = blocked_ns;
  return e;
}

/// Ten seconds of source -> decode -> track -> fuse -> sink in which track works nearly all the time.
GraphSnapshot slow_track() {
  constexpr std::int64_t kSecond = 1'000'000'000;
  GraphSnapshot s{.elapsed_ns = 10 * kSecond, .workers = 4, .stages = {}, .edges = {}};
  s.stages = {stage("source", {kSecond / 10, 0, 9 * kSecond, 0}), stage("decode", {3 * kSecond, 0, 7 * kSecond, 0}),
              stage("track", {9 * kSecond + kSecond / 2, kSecond / 2, 0, 0}),
              stage("fuse", {kSecond / 10, 9 * kSecond, 0, 0}), stage("sink", {0, 10 * kSecond, 0, 0})};
  s.edges = {edge("source", "decode", 0, 9 * kSecond), edge("decode", "track", kSecond / 2, 7 * kSecond),
             edge("track", "fuse", 9 * kSecond, 0), edge("fuse", "sink", 10 * kSecond, 0)};
  return s;
}

TEST(Bottleneck, the_busiest_stage_with_a_full_input_for_which_the_others_wait) {
  const Bottleneck b = bottleneck_of(slow_track());
  EXPECT_EQ(b.stage, "track");
  EXPECT_EQ(b.words, "track: busy 95 % of the time, its input is full, fuse waits for it");
  const auto loads = loads_of(slow_track());
  EXPECT_EQ(loads[1].waits_for, "room in track");
  EXPECT_EQ(loads[2].waits_for, "decode");
  EXPECT_EQ(loads[3].waits_for, "track");
  EXPECT_DOUBLE_EQ(loads[2].rate_hz, 10);
}

TEST(Bottleneck, another_stage_is_named_when_another_is_slow) {  // control: the answer follows the times, not the place
  GraphSnapshot s = slow_track();
  std::swap(s.stages[1].time_ns, s.stages[2].time_ns);
  EXPECT_EQ(bottleneck_of(s).stage, "decode");
}

TEST(Bottleneck, nobody_when_the_source_waits_for_bursts) {
  GraphSnapshot s = slow_track();
  s.stages[0].time_ns = {1, 9'000'000'000, 0, 0};
  s.stages[2].time_ns = {1'000'000'000, 9'000'000'000, 0, 0};
  const Bottleneck b = bottleneck_of(s);
  EXPECT_EQ(b.stage, "");
  EXPECT_THAT(b.words, StartsWith("none: the stages wait for bursts 90 % of the time"));
}

TEST(Bottleneck, the_workers_where_all_of_them_are_busy_and_no_stage_is) {
  GraphSnapshot s = slow_track();
  s.workers = 2;
  for (StageSnapshot& one : s.stages) one.time_ns = {3'920'000'000, 0, 0, 5'000'000'000};
  const Bottleneck b = bottleneck_of(s);
  EXPECT_EQ(b.stage, "workers");
  EXPECT_THAT(b.words, HasSubstr("all 2 are busy 98 %"));
  EXPECT_EQ(loads_of(s)[2].waits_for, "a worker");
  s.workers = 8;  // control: with workers to spare it is a stage again
  EXPECT_NE(bottleneck_of(s).stage, "workers");
}

TEST(Bottleneck, replicas_are_one_stage_that_is_as_busy_as_each_of_them) {
  GraphSnapshot s = slow_track();
  s.workers = 2;
  s.stages[1].time_ns = s.stages[2].time_ns = {6'000'000'000, 0, 0, 0};
  s.stages[3].time_ns = {7'500'000'000, 0, 0, 0};
  EXPECT_THAT(bottleneck_of(s).words, HasSubstr("38 % of it with fuse")) << "control: strangers to each other";
  s.stages[1].family = s.stages[2].family = "decode";
  const Bottleneck b = bottleneck_of(s);
  EXPECT_EQ(b.stage, "workers");
  EXPECT_THAT(b.words, HasSubstr("61 % of it with decode"));
  s.workers = 8;
  EXPECT_EQ(bottleneck_of(s).stage, "fuse") << "75 % of one stage weigh more than 60 % of each of two";
}

TEST(Bottleneck, the_replicas_of_a_graph_share_their_names_beginning) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 10);
  const auto same = [](const Item<Number>& i) { return i; };
  auto& left = g.add<MapStage>("work0", same);
  auto& right = g.add<MapStage>("work1", same);
  auto& sink = g.add<CollectSink>("sink");
  const std::array<In<Number>*, 2> ins{&left.in, &right.in};
  const std::array<Out<Number>*, 2> outs{&left.out, &right.out};
  g.connect_split<Number>(source.out, ins);
  g.connect_merge<Number>(outs, sink.in);
  EXPECT_EQ(stage_of(g.snapshot(), "work1").family, "work");
  EXPECT_EQ(stage_of(g.snapshot(), "sink").family, "sink");
}

TEST(Bottleneck, nothing_is_said_of_neighbours_that_hardly_wait) {
  GraphSnapshot s = slow_track();
  for (EdgeSnapshot& e : s.edges) e.awaited_ns = e.blocked_ns = 0;
  EXPECT_EQ(bottleneck_of(s).words, "track: busy 95 % of the time");
}

TEST(Bottleneck, of_a_graph_that_has_not_run_there_is_none) {
  EXPECT_EQ(bottleneck_of(GraphSnapshot{}).words, "none: nothing has run yet");
  EXPECT_EQ(bottleneck_of(ToyPipeline(1).graph.snapshot()).stage, "");
}

/// A stage that takes `cost` of the clock's time for each burst.
MapStage& add_stage(Graph& g, ManualClock& clock, const std::string& name, Nanoseconds cost) {
  return g.add<MapStage>(name, [&clock, cost](const Item<Number>& i) {
    clock.advance(cost);
    return i;
  });
}

TEST(Bottleneck, a_run_on_one_worker_is_split_into_its_times) {
  ManualClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 20);
  auto& quick = add_stage(g, clock, "quick", Nanoseconds{10});
  auto& slow = add_stage(g, clock, "slow", Nanoseconds{90});
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, quick.in);
  g.connect(quick.out, slow.in, {.capacity = 1});
  g.connect(slow.out, sink.in);
  ASSERT_TRUE(run_with(1, g));
  const GraphSnapshot s = g.snapshot();
  EXPECT_EQ(s.elapsed_ns, 20 * 100);
  EXPECT_EQ(stage_of(s, "quick").time_ns.running, 20 * 10);
  EXPECT_EQ(stage_of(s, "slow").time_ns.running, 20 * 90);
  const StageTimes& t = stage_of(s, "quick").time_ns;
  EXPECT_LE(t.running + t.waiting + t.blocked + t.ready, s.elapsed_ns) << "no moment counts twice";
  EXPECT_THAT(bottleneck_of(s).words, HasSubstr("workers: the one is busy 100 % of the time, 90 % of it with slow"));
  const auto json = nlohmann::json::parse(to_json(s));
  EXPECT_EQ(json.at("bottleneck").at("stage"), "workers");
  EXPECT_DOUBLE_EQ(json.at("stages")[2].at("busy").get<double>(), 0.9);
  EXPECT_EQ(json.at("stages")[2].at("queue").at("capacity"), 1);
}

}  // namespace
}  // namespace enamel::flow
