// Stages and the edges between them. Built once, checked, then run by an executor.
#pragma once

#include <array>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/flow/stage.hpp"
#include "pipeline/flow/step_observer.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::flow {

/// Counts changes that may make a stage runnable; idle workers wait on it.
struct Signal {
  std::atomic<std::uint32_t> epoch{0};
  std::atomic<std::uint32_t> notifications{0};  ///< by Wakers alone: what parked sources look at

  void bump() noexcept {
    epoch.fetch_add(1, std::memory_order_acq_rel);
    epoch.notify_all();
  }
};

/// Lets another thread say that a source which answered kNotYet should be asked again. Lock-free; a call before, during
/// or after the pull is not lost. May outlive the graph.
class Waker {
 public:
  explicit Waker(std::shared_ptr<Signal> signal) : signal_(std::move(signal)) {}
  void notify() const noexcept {
    signal_->notifications.fetch_add(1, std::memory_order_acq_rel);
    signal_->bump();
  }

 private:
  std::shared_ptr<Signal> signal_;
};

/// Where a stage's time went since the run began, ns.
struct StageTimes {
  std::int64_t running = 0;
  std::int64_t waiting = 0;  ///< for input
  std::int64_t blocked = 0;  ///< no room in an edge behind it
  std::int64_t ready = 0;    ///< for a worker
};
struct StageSnapshot {
  std::string name;
  std::string family;  ///< of replicas; else the name
  bool is_source = false;
  StageState state = StageState::kIdle;
  std::uint64_t in = 0;
  std::uint64_t out = 0;
  std::uint64_t errors = 0;
  std::uint64_t degraded = 0;
  std::uint64_t discarded = 0;
  std::uint64_t last_id = 0;
  std::vector<std::pair<std::string, std::uint64_t>> rejected;  ///< tombstones this stage gave first, by reason
  LogHistogram::Summary service_ns;
  StageTimes time_ns;
};
struct EdgeSnapshot {
  std::string name;  ///< "fuse.view -> register.model"
  std::string from, to;
  std::size_t capacity = 0;  ///< items; 1 for an edge that keeps the latest
  bool is_lossless = true;
  std::size_t delay = 0;    ///< > 0: feedback
  std::uint64_t depth = 0;  ///< items in it now
  std::uint64_t pushed = 0;
  std::uint64_t popped = 0;
  std::uint64_t dropped = 0;
  std::int64_t high_water = 0;
  std::int64_t awaited_ns = 0;  ///< its consumer waited for it
  std::int64_t blocked_ns = 0;  ///< its producer waited for room in it
};
struct GraphSnapshot {
  std::int64_t elapsed_ns = 0;  ///< since the run began, until it ended
  std::size_t workers = 0;
  std::vector<StageSnapshot> stages;  ///< in order of add()
  std::vector<EdgeSnapshot> edges;    ///< in order of connect()
};
/// Times in ms and shares of the run, with what each stage waits for most and which is the bottleneck.
[[nodiscard]] std::string to_json(const GraphSnapshot& snapshot);

class Graph {
 public:
  /// The clock measures service times; it never influences results. It must outlive the graph.
  explicit Graph(const Clock& clock) : clock_(clock), signal_(std::make_shared<Signal>()) {}
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  template <std::derived_from<Stage> S, class... A>
  S& add(A&&... args) {
    auto stage = std::make_unique<S>(std::forward<A>(args)...);
    S& out = *stage;
    stages_.push_back(std::move(stage));
    return out;
  }

  /// An Out may feed several Ins (fan-out shares the payload), an In has one edge.
  template <class T>
  void connect(Out<T>& out, In<T>& in, EdgeSpec spec = {}) {
    if (!may_connect(in)) return;
    Edge<T>* e = make_edge(out, in, spec, 0);
    out.attach({e});
    in.attach({e}, false);
  }

  /// Delay edge (synchronous data flow, Lee and Messerschmitt 1987): step n of the consumer sees what the producer
  /// emitted for step n − delay, and `initial` in the first `delay` steps. Never blocks the producer.
  template <class T>
  void connect_feedback(Out<T>& out, In<T>& in, std::size_t delay, const Item<T>& initial) {
    if (!may_connect(in) || !may_delay(in, delay, 1)) return;
    Edge<T>* e = make_edge(out, in, {.capacity = delay, .on_full = OnFull::kBlock}, delay);
    for (std::size_t i = 0; i < delay; ++i) e->push(initial);
    out.attach({e});
    in.attach({e}, true);
  }

  /// Deals the items of `out` in turn to the Ins of replicas of one stage, which must not keep state between bursts.
  /// connect_merge() restores the order, so the result is that of a single stage.
  template <class T>
  void connect_split(Out<T>& out, std::span<In<T>* const> replicas, EdgeSpec spec = {}) {
    std::vector<Edge<T>*> lanes;
    for (In<T>* in : replicas) {
      if (!may_connect(*in)) return;
      lanes.push_back(make_edge(out, *in, spec, 0));
      in->attach({lanes.back()}, false);
    }
    if (!lanes.empty()) out.attach(std::move(lanes));
    std::vector<Stage*> owners;
    for (In<T>* in : replicas) owners.push_back(&in->owner());
    name_family(owners);
  }
  /// Delay edges into replicas, as one into a single stage would be. delay: a multiple of their number, so that each
  /// replica gets what is meant for the items that it is dealt.
  template <class T>
  void connect_feedback_split(Out<T>& out, std::span<In<T>* const> replicas, std::size_t delay,
                              const Item<T>& initial) {
    std::vector<Edge<T>*> lanes;
    for (In<T>* in : replicas) {
      if (!may_connect(*in) || !may_delay(*in, delay, replicas.size())) return;
      lanes.push_back(make_edge(out, *in, {.capacity = delay, .on_full = OnFull::kBlock}, delay));
      in->attach({lanes.back()}, true);
    }
    for (std::size_t i = 0; i < delay && !lanes.empty(); ++i) lanes[i % lanes.size()]->push(initial);
    if (!lanes.empty()) out.attach(std::move(lanes));
  }
  template <class T>
  void connect_merge(std::span<Out<T>* const> replicas, In<T>& in, EdgeSpec spec = {}) {
    if (!may_connect(in)) return;
    std::vector<Edge<T>*> lanes;
    for (Out<T>* out : replicas) {
      lanes.push_back(make_edge(*out, in, spec, 0));
      out->attach({lanes.back()});
    }
    in.attach(std::move(lanes), false);
  }

  /// Unconnected ports, duplicate names, zero capacity or delay, a delay that replicas do not share out evenly, cycles
  /// without delay, joins of two sources, lossy paths that reach a lossless stage. Errors: kInternal naming the stage:
  /// a graph is built by a program, not by a user.
  [[nodiscard]] Result<void> validate() const;

  /// From any thread, also while the graph runs.
  [[nodiscard]] GraphSnapshot snapshot() const;
  [[nodiscard]] Waker waker() const { return Waker(signal_); }

  /// Watches the steps of the run; null: nobody. Before the run begins; it must outlive it.
  void observe(StepObserver* observer) noexcept { observer_ = observer; }

  /// For executors. Stages in topological order (of add() where there is a choice); valid graphs only.
  [[nodiscard]] std::vector<Stage*> topological_order() const;
  [[nodiscard]] const Clock& clock() const noexcept { return clock_; }
  [[nodiscard]] StepObserver* observer() const noexcept { return observer_; }
  [[nodiscard]] Signal& signal() const noexcept { return *signal_; }
  /// A graph runs once: edges and stages keep their end. False from the second call on.
  [[nodiscard]] bool begin_run(std::size_t workers) noexcept;
  void end_run() noexcept { ended_ns_.store(to_ns(clock_.now()), std::memory_order_release); }

 private:
  template <class T>
  Edge<T>* make_edge(Out<T>& out, In<T>& in, EdgeSpec spec, std::size_t delay) {
    check_spec(out, in, spec);
    spec.capacity = spec.capacity > 0 ? spec.capacity : 1;
    auto edge = std::make_unique<Edge<T>>(out.owner(), out.name(), in.owner(), in.name(), spec, delay);
    Edge<T>* e = edge.get();
    edges_.push_back(std::move(edge));
    return e;
  }
  /// What all their names begin with.
  static void name_family(std::span<Stage* const> replicas);
  [[nodiscard]] bool may_connect(const InBase& in);
  [[nodiscard]] bool may_delay(const InBase& in, std::size_t delay, std::size_t replicas);
  void check_spec(const OutBase& out, const InBase& in, const EdgeSpec& spec);
  [[nodiscard]] Result<void> validate_ports() const;
  [[nodiscard]] Result<void> validate_flow() const;
  [[nodiscard]] std::size_t index_of(const Stage& stage) const;

  const Clock& clock_;
  StepObserver* observer_ = nullptr;
  std::shared_ptr<Signal> signal_;
  std::vector<std::unique_ptr<Stage>> stages_;
  std::vector<std::unique_ptr<EdgeBase>> edges_;
  std::vector<std::string> build_errors_;
  bool ran_ = false;
  // Read by snapshot() from any thread.
  std::atomic<std::size_t> workers_{0};  ///< 0: not begun
  std::atomic<std::int64_t> begun_ns_{0};
  std::atomic<std::int64_t> ended_ns_{-1};  ///< -1: not yet
};

}  // namespace enamel::flow
