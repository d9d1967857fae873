// An observer sees every step and pull once, begun and ended on one thread, with its burst and what became of it.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <thread>

#include "tests/unit/flow/toy_stages.hpp"

namespace enamel::flow {
namespace {

struct Seen {
  std::string stage;
  std::optional<BurstId> at_begin;
  StepOutcome outcome;
};

class NotingObserver final : public StepObserver {
 public:
  void begin(const Stage& stage, std::optional<BurstId> burst) noexcept override {
    const std::lock_guard lock(mutex_);
    well_formed = well_formed && !open_.contains(std::this_thread::get_id());
    open_[std::this_thread::get_id()] = {&stage, burst};
  }
  void end(const Stage& stage, const StepOutcome& outcome) noexcept override {
    const std::lock_guard lock(mutex_);
    const auto begun = open_.find(std::this_thread::get_id());
    well_formed = well_formed && begun != open_.end() && begun->second.first == &stage;
    if (begun == open_.end()) return;
    seen.push_back({stage.name(), begun->second.second, outcome});
    open_.erase(begun);
  }
  [[nodiscard]] bool all_ended() const { return open_.empty(); }
  [[nodiscard]] std::vector<Seen> of(const std::string& stage) const {
    std::vector<Seen> out;
    std::ranges::copy_if(seen, std::back_inserter(out), [&](const Seen& s) { return s.stage == stage; });
    return out;
  }

  bool well_formed = true;  ///< each end() closes the begin() of its thread
  std::vector<Seen> seen;

 private:
  std::mutex mutex_;
  std::map<std::thread::id, std::pair<const Stage*, std::optional<BurstId>>> open_;
};

class Observer : public ::testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InlineAndWorkers, Observer, ::testing::Values(0, 1, 3));

TEST_P(Observer, sees_every_step_once_in_the_order_of_bursts) {
  ToyPipeline p(60);
  NotingObserver observer;
  p.graph.observe(&observer);
  ASSERT_TRUE(run_with(GetParam(), p.graph));
  EXPECT_TRUE(observer.well_formed);
  EXPECT_TRUE(observer.all_ended());
  for (const char* stage : {"decode", "register", "fuse", "sink"}) {
    const std::vector<Seen> steps = observer.of(stage);
    ASSERT_EQ(steps.size(), 60U) << stage;
    for (std::size_t i = 0; i < steps.size(); ++i) {
      EXPECT_EQ(steps[i].at_begin, BurstId{i}) << stage;
      EXPECT_EQ(steps[i].outcome.burst, BurstId{i}) << stage;
      EXPECT_EQ(steps[i].outcome.rejected, i % 7 == 3) << stage << " at " << i;
      EXPECT_FALSE(steps[i].outcome.failed);
    }
  }
}

TEST_P(Observer, sees_a_pull_with_the_burst_that_it_brought_and_the_last_without) {
  ToyPipeline p(10);
  NotingObserver observer;
  p.graph.observe(&observer);
  ASSERT_TRUE(run_with(GetParam(), p.graph));
  const std::vector<Seen> pulls = observer.of("source");
  ASSERT_EQ(pulls.size(), 11U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(pulls[i].outcome.burst, BurstId{i});
  EXPECT_EQ(pulls.back().outcome.burst, std::nullopt);
  for (const Seen& pull : pulls) EXPECT_EQ(pull.at_begin, std::nullopt);
}

TEST_P(Observer, sees_a_step_that_failed) {
  const SteadyClock clock;
  Graph g(clock);
  auto& source = g.add<CountingSource>("source", 8);
  auto& map = g.add<MapStage>("map", [](const Item<Number>& i) -> Item<Number> {
    if (i.id.value == 4) throw std::runtime_error("broken");
    return i;
  });
  auto& sink = g.add<CollectSink>("sink");
  g.connect(source.out, map.in);
  g.connect(map.out, sink.in);
  NotingObserver observer;
  g.observe(&observer);
  ASSERT_FALSE(run_with(GetParam(), g));
  const std::vector<Seen> steps = observer.of("map");
  ASSERT_EQ(steps.size(), 5U);
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i].outcome.failed, i == 4);
  EXPECT_TRUE(observer.all_ended());
}

TEST_P(Observer, changes_nothing) {
  ToyPipeline alone(50);
  ASSERT_TRUE(run_with(GetParam(), alone.graph));
  ToyPipeline watched(50);
  NotingObserver observer;
  watched.graph.observe(&observer);
  ASSERT_TRUE(run_with(GetParam(), watched.graph));
  EXPECT_EQ(alone.sink->hash(), watched.sink->hash());
}

}  // namespace
}  // namespace enamel::flow
