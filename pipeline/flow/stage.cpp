#include "pipeline/flow/stage.hpp"

#include <cstring>

namespace enamel::flow {

InBase::InBase(Stage& owner, std::string_view name) : owner_(owner), name_(name) { owner.ins_.push_back(this); }
OutBase::OutBase(Stage& owner, std::string_view name) : owner_(owner), name_(name) { owner.outs_.push_back(this); }

OnError Stage::on_error(const Error& /*error*/) noexcept { return OnError::kFatal; }

std::string_view to_string(StageState s) noexcept {
  switch (s) {
    case StageState::kIdle:
      return "idle";
    case StageState::kWaitingInput:
      return "waiting_input";
    case StageState::kBlockedOutput:
      return "blocked_output";
    case StageState::kReady:
      return "ready";
    case StageState::kRunning:
      return "running";
    case StageState::kDone:
      return "done";
  }
  return "?";
}

void RejectCounters::add(const char* reason) noexcept {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const char* known = slots_[i].reason.load(std::memory_order_relaxed);
    if (known == nullptr) {
      known = i + 1 < slots_.size() ? reason : "other";
      slots_[i].reason.store(known, std::memory_order_release);
    }
    if (i + 1 == slots_.size() || std::strcmp(known, reason) == 0) {
      slots_[i].count.add();
      return;
    }
  }
}

std::vector<std::pair<std::string, std::uint64_t>> RejectCounters::snapshot() const {
  std::vector<std::pair<std::string, std::uint64_t>> out;
  for (const Slot& s : slots_) {
    if (const char* reason = s.reason.load(std::memory_order_acquire)) out.emplace_back(reason, s.count.value());
  }
  return out;
}

}  // namespace enamel::flow
