#include "pipeline/flow/stage_runner.hpp"

#include <algorithm>
#include <exception>

namespace enamel::flow {

void RunState::fail_with(Error e) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = std::move(e);
  failed.store(true, std::memory_order_release);
}

std::optional<Error> RunState::error() {
  const std::lock_guard lock(mutex_);
  return error_;
}

bool StageRunner::advance() {
  switch (phase_) {
    case Phase::kActive:
      return stage_.as_source() != nullptr ? advance_source() : advance_stage();
    case Phase::kDiscarding:
      return discard_inputs();
    case Phase::kDone:
      break;
  }
  return false;
}

void StageRunner::look() {
  if (phase_ == Phase::kActive) enter(readiness(), run_.graph.clock().now());
}

StageRunner::Readiness StageRunner::readiness() {
  if (stage_.as_source() != nullptr && source_parked()) return {StageState::kWaitingInput, nullptr};
  for (InBase* in : stage_.ins()) {
    if (in->head() == nullptr) return {StageState::kWaitingInput, &in->next_edge()};
  }
  for (OutBase* out : stage_.outs()) {
    if (EdgeBase* full = out->full_edge()) return {StageState::kBlockedOutput, full};
  }
  return {StageState::kReady, nullptr};
}

bool StageRunner::source_parked() const noexcept {
  return parked_ && run_.graph.signal().notifications.load(std::memory_order_acquire) == parked_at_;
}

void StageRunner::enter(const Readiness& next, HostTime now) {
  StageStats& stats = stage_.stats();
  const StageState before = stats.state.load(std::memory_order_relaxed);
  if (before == next.state && held_by_ == next.edge) return;
  const std::int64_t lasted = to_ns(now) - stats.since_ns.load(std::memory_order_relaxed);
  const std::uint64_t ns =
      before == StageState::kIdle ? 0 : static_cast<std::uint64_t>(std::max<std::int64_t>(lasted, 0));
  stats.time_in_ns[static_cast<std::size_t>(before)].add(ns);
  if (before == StageState::kWaitingInput && held_by_ != nullptr) held_by_->note_awaited(ns);
  if (before == StageState::kBlockedOutput) held_by_->note_blocked(ns);
  held_by_ = next.edge;
  stats.since_ns.store(to_ns(now), std::memory_order_relaxed);
  stats.state.store(next.state, std::memory_order_relaxed);
}

bool StageRunner::advance_source() {
  if (run_.sources_must_end()) {
    end();
    return true;
  }
  // Read before the pull: a notification during it changes the count and the source is asked again.
  const std::uint32_t notifications = run_.graph.signal().notifications.load(std::memory_order_acquire);
  if (const Readiness r = readiness(); r.state != StageState::kReady) {
    enter(r, run_.graph.clock().now());
    return false;
  }
  parked_ = false;
  parked_at_ = notifications;
  do_pull(*stage_.as_source());
  return true;
}

bool StageRunner::advance_stage() {
  const auto& ins = stage_.ins();
  if (std::any_of(ins.begin(), ins.end(), [](InBase* i) { return i->ended(); })) {
    end();
    return true;
  }
  if (const Readiness r = readiness(); r.state != StageState::kReady) {
    enter(r, run_.graph.clock().now());
    return false;
  }
  do_step();
  return true;
}

void StageRunner::begin_step(bool degraded, HostTime now) {
  enter({StageState::kRunning, nullptr}, now);
  for (InBase* in : stage_.ins()) in->begin_step();
  for (OutBase* out : stage_.outs()) out->begin_step(degraded);
}

void StageRunner::end_step(HostTime begun) {
  const HostTime now = run_.graph.clock().now();
  stage_.stats().service_ns.record((now - begun).count());
  enter({StageState::kReady, nullptr}, now);
}

void StageRunner::do_pull(Source& source) {
  const HostTime begun = run_.graph.clock().now();
  begin_step(degraded_, begun);
  watch_begin(std::nullopt);
  Result<Pull> pulled = Pull::kEnd;
  try {
    pulled = source.pull();
  } catch (const std::exception& e) {
    pulled = fail(ErrorCode::kInternal, "stage '" + stage_.name() + "' threw: " + e.what());
  }
  watch_end(nullptr, !pulled);
  if (!pulled) {
    stage_.stats().errors.add();
    run_.fail_with(std::move(pulled).error());
    end();
    return;
  }
  if (*pulled != Pull::kItem) {
    const auto& outs = stage_.outs();
    if (std::any_of(outs.begin(), outs.end(), [](OutBase* o) { return o->emitted() > 0; })) {
      break_contract("emitted an item and said it has none");
    } else if (*pulled == Pull::kEnd) {
      end();
    } else {
      parked_ = true;
    }
    return;
  }
  const ItemHead head = stage_.outs().empty() ? ItemHead{} : stage_.outs().front()->last();
  if (last_id_ && !(*last_id_ < head.id)) return break_contract("emitted burst ids that do not increase");
  last_id_ = head.id;
  if (!took_and_emitted_one(head)) return;
  end_step(begun);
  count_output(ItemHead{});
}

void StageRunner::do_step() {
  ItemHead head;
  if (!inputs_agree(head)) return;
  const HostTime begun = run_.graph.clock().now();
  begin_step(degraded_ || head.degraded, begun);
  stage_.stats().in.add();
  stage_.stats().last_id.store(head.id.value, std::memory_order_relaxed);
  watch_begin(head.id);
  if (!head.ok() && !stage_.handles_rejected()) {
    forward_rejected(head);
    watch_end(&head, false);
    return;
  }
  const Result<void> done = guarded_step();
  watch_end(&head, !done);
  end_step(begun);
  if (!done) return handle_error(done.error(), head);
  if (took_and_emitted_one(head)) count_output(head);
}

Result<void> StageRunner::guarded_step() {
  try {
    return stage_.step();
  } catch (const std::exception& e) {
    return fail(ErrorCode::kInternal, "stage '" + stage_.name() + "' threw: " + e.what());
  }
}

/// All forward inputs must carry the same burst; `head` becomes its description, rejected if any of them is.
bool StageRunner::inputs_agree(ItemHead& head) {
  const InBase* first = nullptr;
  for (InBase* in : stage_.ins()) {
    if (in->is_feedback()) continue;
    const ItemHead& h = *in->head();
    if (first == nullptr) {
      first = in;
      head = h;
    }
    if (h.id != head.id) {
      break_contract("received burst " + std::to_string(head.id.value) + " on '" + first->name() + "' but " +
                     std::to_string(h.id.value) + " on '" + in->name() + "'");
      return false;
    }
    if (head.ok()) head.rejected = h.rejected;
    head.degraded = head.degraded || h.degraded;
  }
  return true;
}

void StageRunner::forward_rejected(const ItemHead& head) {
  for (InBase* in : stage_.ins()) in->discard();
  for (OutBase* out : stage_.outs()) out->emit_rejected(head, head.rejected);
  count_output(head);
}

bool StageRunner::took_and_emitted_one(const ItemHead& head) {
  for (const InBase* in : stage_.ins()) {
    if (in->taken() == 1) continue;
    break_contract("took " + std::to_string(in->taken()) + " items from '" + in->name() + "' in one step, not one");
    return false;
  }
  for (const OutBase* out : stage_.outs()) {
    if (out->emitted() != 1) {
      break_contract("emitted " + std::to_string(out->emitted()) + " items on '" + out->name() + "' for burst " +
                     std::to_string(head.id.value) + ", not one (a burst without result is make_rejected)");
      return false;
    }
    if (out->last().id != head.id) {
      break_contract("emitted burst " + std::to_string(out->last().id.value) + " on '" + out->name() + "' for burst " +
                     std::to_string(head.id.value));
      return false;
    }
  }
  return true;
}

void StageRunner::count_output(const ItemHead& in) {
  StageStats& stats = stage_.stats();
  stats.out.add();
  const auto& outs = stage_.outs();
  if (outs.empty()) return;
  stats.last_id.store(outs.front()->last().id.value, std::memory_order_relaxed);
  if (std::any_of(outs.begin(), outs.end(), [](OutBase* o) { return o->last().degraded; })) stats.degraded.add();
  const auto first = std::find_if(outs.begin(), outs.end(), [](OutBase* o) { return !o->last().ok(); });
  if (in.ok() && first != outs.end()) stats.rejected.add((*first)->last().rejected);
}

void StageRunner::handle_error(const Error& error, const ItemHead& head) {
  stage_.stats().errors.add();
  const OnError action = stage_.on_error(error);
  if (action == OnError::kFatal) {
    run_.fail_with(error);
    end();
    return;
  }
  if (action == OnError::kDegrade) degraded_ = true;
  for (InBase* in : stage_.ins()) {
    if (in->taken() == 0) in->discard();
  }
  for (OutBase* out : stage_.outs()) {
    if (out->emitted() == 0) out->emit_rejected(head, "stage_error");
  }
  if (took_and_emitted_one(head)) count_output(head);
}

void StageRunner::break_contract(const std::string& what) {
  run_.fail_with({ErrorCode::kInternal, "stage '" + stage_.name() + "' " + what});
  end();
}

/// Nothing will be emitted any more. What still arrives is discarded, so that a stage upstream never blocks on us.
void StageRunner::end() {
  stage_.stop();
  for (OutBase* out : stage_.outs()) out->close();
  parked_ = false;
  phase_ = Phase::kDiscarding;
  enter({StageState::kDone, nullptr}, run_.graph.clock().now());
  static_cast<void>(discard_inputs());
}

bool StageRunner::discard_inputs() {
  bool did = false;
  bool all_ended = true;
  for (InBase* in : stage_.ins()) {
    for (; in->head() != nullptr; did = true) {
      in->discard();
      if (in->is_feedback()) continue;
      stage_.stats().discarded.add();
      if (run_.failed.load(std::memory_order_acquire)) continue;
      run_.fail_with(
          {ErrorCode::kInternal, "stage '" + stage_.name() + "' ended while '" + in->name() + "' still brought items"});
    }
    if (!in->is_feedback() && !in->ended()) all_ended = false;
  }
  if (all_ended) finish();
  return did || all_ended;
}

void StageRunner::finish() {
  phase_ = Phase::kDone;
  run_.unfinished.fetch_sub(1, std::memory_order_acq_rel);
}

}  // namespace enamel::flow
