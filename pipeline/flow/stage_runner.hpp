// Internal to graph: the life of one stage in a run. Holds the rules; the executors only decide who calls it when.
#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "pipeline/flow/graph.hpp"

namespace enamel::flow {

/// Shared by all stages of a run.
struct RunState {
  RunState(Graph& g, const std::stop_token& s) : graph(g), stop(s) {}

  Graph& graph;
  std::stop_token stop;
  std::atomic<bool> failed{false};
  std::atomic<std::size_t> unfinished{0};

  void fail_with(Error e);
  [[nodiscard]] bool sources_must_end() const noexcept {
    return failed.load(std::memory_order_acquire) || stop.stop_requested();
  }
  [[nodiscard]] bool finished() const noexcept { return unfinished.load(std::memory_order_acquire) == 0; }
  [[nodiscard]] std::optional<Error> error();

 private:
  std::mutex mutex_;  // failures only
  std::optional<Error> error_;
};

/// What the observer is told of the step or pull that ends. in: what a step took; null for a pull, whose burst is what
/// it emitted.
[[nodiscard]] StepOutcome outcome_of(const Stage& stage, const ItemHead* in, bool failed);

/// One worker at a time, by claim().
class StageRunner {
 public:
  StageRunner(Stage& stage, RunState& run) : stage_(stage), run_(run) {}

  [[nodiscard]] bool claim() noexcept { return !claimed_.exchange(true, std::memory_order_acquire); }
  void release() noexcept { claimed_.store(false, std::memory_order_release); }

  /// Does the one thing that can be done now: a step, a pull, ending. False: nothing.
  [[nodiscard]] bool advance();
  /// Notes what the stage waits for, so that its times say so even when no worker is free to try it.
  void look();
  [[nodiscard]] Stage& stage() const noexcept { return stage_; }
  /// A source that waits for its Waker.
  [[nodiscard]] bool parked() const noexcept { return parked_; }

 private:
  enum class Phase : std::uint8_t { kActive, kDiscarding, kDone };

  bool advance_source();
  bool advance_stage();
  bool discard_inputs();
  void do_pull(Source& source);
  void do_step();
  Result<void> guarded_step();
  void forward_rejected(const ItemHead& head);
  void handle_error(const Error& error, const ItemHead& head);
  void end();
  void finish();
  void break_contract(const std::string& what);
  [[nodiscard]] bool inputs_agree(ItemHead& head);
  [[nodiscard]] bool took_and_emitted_one(const ItemHead& head);
  void count_output(const ItemHead& in);
  /// kWaitingInput, kBlockedOutput or kReady, and the edge that makes it so.
  struct Readiness {
    StageState state = StageState::kReady;
    EdgeBase* edge = nullptr;
  };
  [[nodiscard]] Readiness readiness();
  [[nodiscard]] bool source_parked() const noexcept;
  void enter(const Readiness& next, HostTime now);
  void begin_step(bool degraded, HostTime now);
  void end_step(HostTime begun);
  void watch_begin(std::optional<BurstId> burst) const {
    if (StepObserver* observer = run_.graph.observer()) observer->begin(stage_, burst);
  }
  /// in: what a step took; null for a pull.
  void watch_end(const ItemHead* in, bool failed) const {
    if (StepObserver* observer = run_.graph.observer()) observer->end(stage_, outcome_of(stage_, in, failed));
  }

  Stage& stage_;
  RunState& run_;
  std::atomic<bool> claimed_{false};
  Phase phase_ = Phase::kActive;
  bool degraded_ = false;
  bool parked_ = false;
  std::uint32_t parked_at_ = 0;
  EdgeBase* held_by_ = nullptr;  ///< of the present state
  std::optional<BurstId> last_id_;
};

}  // namespace enamel::flow
