#include "firmware/acquire/edge_log.hpp"

#include <algorithm>

namespace enamel::fw {
namespace {
// A stuck line or a stepped clock must not grow memory: four frames of every kind are far below this.
constexpr std::size_t kMaxPending = 256;
}  // namespace

void EdgeLog::push(const Edge& edge) {
  const auto earlier = [](DeviceTime t, const auto& e) { return t < e.t; };
  if (edge.kind == EdgeKind::kGate) {  // opened by this firmware: never lost, every gate must end in an outcome
    gates_.insert(std::upper_bound(gates_.begin(), gates_.end(), edge.t, earlier), Gate{edge.number, edge.t});
    return;
  }
  if (edge.t <= done_) {
    ++late_;
    return;
  }
  pending_.insert(std::upper_bound(pending_.begin(), pending_.end(), edge.t, earlier), edge);
  if (pending_.size() <= kMaxPending) return;
  pending_.pop_back();  // the one farthest in the future
  ++late_;
}

void EdgeLog::advance(DeviceTime t) {
  std::size_t n = 0;
  while (n < pending_.size() && pending_[n].t <= t) interpret(pending_[n++]);
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(n));
  done_ = std::max(done_, t);
  const DeviceTime horizon = done_ - memory_;
  while (!strobes_.empty() && strobes_.front().t < horizon) strobes_.pop_front();
  while (!patterns_.empty() && patterns_.front().rise < horizon) patterns_.pop_front();
}

void EdgeLog::interpret(const Edge& edge) {
  switch (edge.kind) {
    case EdgeKind::kGate:
      break;
    case EdgeKind::kStrobe:
      strobes_.push_back({edge.t, false});
      break;
    case EdgeKind::kT1:
      set_started_ = true;
      break;
    case EdgeKind::kT2Rise:
      if (set_started_) {
        last_index_ = 0;
      } else if (last_index_) {
        *last_index_ = std::min(*last_index_ + 1, 255);
      }
      set_started_ = false;
      patterns_.push_back({last_index_.value_or(255), edge.t, std::nullopt});
      break;
    case EdgeKind::kT2Fall:
      if (!patterns_.empty() && !patterns_.back().fall) patterns_.back().fall = edge.t;
      break;
  }
}

Strobe* EdgeLog::nearest_strobe(DeviceTime t) noexcept {
  Strobe* best = nullptr;
  for (Strobe& s : strobes_) {
    if (best == nullptr || std::chrono::abs(s.t - t) < std::chrono::abs(best->t - t)) best = &s;
  }
  return best;
}

std::vector<Pattern> EdgeLog::patterns_in(DeviceTime begin, DeviceTime end) const {
  std::vector<Pattern> found;
  for (const Pattern& p : patterns_) {
    if (p.rise >= begin && p.rise < end) found.push_back(p);
  }
  return found;
}

bool EdgeLog::lit_across(DeviceTime begin) const noexcept {
  return std::any_of(patterns_.begin(), patterns_.end(),
                     [&](const Pattern& p) { return p.rise < begin && p.fall && *p.fall > begin; });
}

std::optional<Gate> EdgeLog::take_gate(DeviceTime until) {
  if (gates_.empty() || gates_.front().t > until) return std::nullopt;
  const Gate gate = gates_.front();
  gates_.pop_front();
  return gate;
}

}  // namespace enamel::fw
