#include "pipeline/flow/executor.hpp"

#include <pthread.h>

#include <deque>
#include <thread>

#include "pipeline/flow/stage_runner.hpp"

namespace enamel::flow {
namespace {

/// One run: validated and started stages with their runners, in topological order.
class Run {
 public:
  Run(Graph& graph, const std::stop_token& stop) : state_(graph, stop) {}

  Result<void> start(std::size_t workers) {
    if (!state_.graph.begin_run(workers)) return fail(ErrorCode::kInternal, "a graph runs only once");
    ENAMEL_TRY(state_.graph.validate());
    for (Stage* stage : state_.graph.topological_order()) {
      if (Result<void> started = stage->start(); !started) {
        while (!runners_.empty()) {
          runners_.back().stage().stop();
          runners_.pop_back();
        }
        return started;
      }
      runners_.emplace_back(*stage, state_);
    }
    state_.unfinished.store(runners_.size(), std::memory_order_release);
    return {};
  }

  /// Every stage once, from the sources down. True if any did something.
  bool sweep() {
    bool did = false;
    for (StageRunner& r : runners_) did = r.advance() || did;
    return did;
  }

  /// The runnable stage nearest the sinks: what is under way is finished before anything new begins.
  bool advance_any() {
    for (std::size_t i = runners_.size(); i-- > 0;) {
      if (!runners_[i].claim()) continue;
      const bool did = runners_[i].advance();
      runners_[i].release();
      if (did) return true;
    }
    return false;
  }

  /// After a step, before the others are told: which stages wait for a worker now shows in their times alone.
  void look() {
    for (StageRunner& r : runners_) {
      if (!r.claim()) continue;
      r.look();
      r.release();
    }
  }

  bool any_parked() const {
    for (const StageRunner& r : runners_) {
      if (r.parked()) return true;
    }
    return false;
  }

  Result<void> outcome() {
    state_.graph.end_run();
    if (auto e = state_.error()) return tl::unexpected<Error>(std::move(*e));
    return {};
  }
  RunState& state() { return state_; }
  Signal& signal() { return state_.graph.signal(); }

 private:
  RunState state_;
  std::deque<StageRunner> runners_;
};

/// An epoch read before looking for work cannot miss a change made after the look: wait() then returns at once.
void work(Run& run) {
  while (!run.state().finished()) {
    const std::uint32_t epoch = run.signal().epoch.load(std::memory_order_acquire);
    if (run.advance_any()) {
      run.look();
      run.signal().bump();
    } else if (!run.state().finished()) {
      run.signal().epoch.wait(epoch, std::memory_order_acquire);
    }
  }
}

}  // namespace

Result<void> InlineExecutor::run(Graph& graph, const std::stop_token& stop) {
  Run run(graph, stop);
  ENAMEL_TRY(run.start(1));
  const std::stop_callback wake(stop, [&run] { run.signal().bump(); });
  while (!run.state().finished()) {
    const std::uint32_t epoch = run.signal().epoch.load(std::memory_order_acquire);
    if (run.sweep()) continue;
    if (!run.any_parked()) return fail(ErrorCode::kInternal, "the graph stalled: no stage can run and no source waits");
    run.signal().epoch.wait(epoch, std::memory_order_acquire);
  }
  return run.outcome();
}

Result<void> WorkerExecutor::run(Graph& graph, const std::stop_token& stop) {
  Run run(graph, stop);
  ENAMEL_TRY(run.start(workers_));
  const std::stop_callback wake(stop, [&run] { run.signal().bump(); });
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < workers_; ++i) {
      others.emplace_back([&run, i] {
        pthread_setname_np(pthread_self(), ("enamel-work-" + std::to_string(i)).c_str());
        work(run);
      });
    }
    work(run);
  }
  return run.outcome();
}

}  // namespace enamel::flow
