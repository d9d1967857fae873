// A step of the pipeline: typed inputs and outputs and one function that turns one item each into one item each.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/flow/port.hpp"
#include "protocol/base/metrics.hpp"
#include "protocol/base/result.hpp"

namespace enamel::flow {

/// What becomes of the run when step() returns an error. Data that cannot be used is not an error: emit
/// make_rejected().
enum class OnError : std::uint8_t {
  kFatal,    ///< the run ends: sources stop, what is under way drains, run() returns the error
  kSkip,     ///< this burst becomes a tombstone "stage_error"
  kDegrade,  ///< as kSkip, and everything the stage emits from now on is marked degraded; it has switched to a fallback
};

enum class StageState : std::uint8_t {
  kIdle,           ///< not looked at yet
  kWaitingInput,   ///< some In is empty; a source: nothing to emit
  kBlockedOutput,  ///< some edge behind an Out is full
  kReady,          ///< could run, but no worker is free
  kRunning,
  kDone,
};
inline constexpr std::size_t kStageStates = 6;
[[nodiscard]] std::string_view to_string(StageState s) noexcept;

/// Tombstones that a stage gave first, by reason. One writer; up to 15 reasons, further ones under "other".
class RejectCounters {
 public:
  void add(const char* reason) noexcept;
  [[nodiscard]] std::vector<std::pair<std::string, std::uint64_t>> snapshot() const;

 private:
  struct Slot {
    std::atomic<const char*> reason{nullptr};
    Counter count;
  };
  std::array<Slot, 16> slots_;
};

/// One writer at a time (the worker that runs the stage), any reader.
struct StageStats {
  Counter in;         ///< steps begun with input (sources: 0)
  Counter out;        ///< steps that emitted
  Counter errors;     ///< steps that returned an error
  Counter degraded;   ///< steps whose output was marked degraded
  Counter discarded;  ///< inputs thrown away after a fatal error downstream of a source
  RejectCounters rejected;
  LogHistogram service_ns;
  std::atomic<StageState> state{StageState::kIdle};
  std::atomic<std::int64_t> since_ns{0};         ///< when it entered `state`, on the graph's clock
  std::array<Counter, kStageStates> time_in_ns;  ///< spent in each state before
  std::atomic<std::uint64_t> last_id{0};
};

class Source;

/// Derive, declare ports as members (`In<Burst> burst{*this, "burst"};`), write step(). No two workers are ever inside
/// one stage at a time, so its members need no locks. step() must not block, sleep or do I/O.
class Stage {
 public:
  explicit Stage(std::string name) : name_(std::move(name)) {}
  virtual ~Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// What replicas of one stage are called together; its own name otherwise.
  [[nodiscard]] const std::string& family() const noexcept { return family_.empty() ? name_ : family_; }
  void set_family(std::string name) { family_ = std::move(name); }

  /// Before the first step, in topological order, on the thread that calls run().
  [[nodiscard]] virtual Result<void> start() { return {}; }
  /// Takes one item from every In and emits one to every Out, of the same burst. Called only when that is possible.
  [[nodiscard]] virtual Result<void> step() = 0;
  /// Once, after the last step and after everything upstream has stopped; also after errors, if start() succeeded.
  virtual void stop() noexcept {}
  /// False: the executor passes tombstones on and step() sees accepted items only. Sinks that count, and stages whose
  /// output is wanted for every burst (the model view of a rejected burst is the last one), say true.
  [[nodiscard]] virtual bool handles_rejected() const noexcept { return false; }
  [[nodiscard]] virtual OnError on_error(const Error& error) noexcept;
  [[nodiscard]] virtual Source* as_source() noexcept { return nullptr; }

  [[nodiscard]] const std::vector<InBase*>& ins() const noexcept { return ins_; }
  [[nodiscard]] const std::vector<OutBase*>& outs() const noexcept { return outs_; }
  [[nodiscard]] StageStats& stats() noexcept { return stats_; }
  [[nodiscard]] const StageStats& stats() const noexcept { return stats_; }

 private:
  friend class InBase;
  friend class OutBase;
  std::string name_, family_;
  std::vector<InBase*> ins_;
  std::vector<OutBase*> outs_;
  StageStats stats_;
};

enum class Pull : std::uint8_t {
  kItem,    ///< one item was emitted on every Out
  kNotYet,  ///< nothing was emitted; ask again after Waker::notify()
  kEnd,     ///< nothing was emitted and nothing will be
};

/// A stage without inputs. Ids it emits must increase strictly.
class Source : public Stage {
 public:
  using Stage::Stage;
  [[nodiscard]] virtual Result<Pull> pull() = 0;
  [[nodiscard]] Result<void> step() final { return fail(ErrorCode::kInternal, "a source is pulled, not stepped"); }
  [[nodiscard]] Source* as_source() noexcept final { return this; }
};

}  // namespace enamel::flow
