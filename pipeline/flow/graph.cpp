#include "pipeline/flow/graph.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace enamel::flow {
namespace {

std::string port_name(const Stage& stage, const std::string& port) { return "'" + stage.name() + "." + port + "'"; }

/// Which source, and behind which lossy edges, a stage's items come from: a join needs the same on all its inputs,
/// otherwise they do not carry the same bursts.
struct Origin {
  const Stage* source = nullptr;
  std::set<const EdgeBase*> lossy;
  bool operator==(const Origin&) const = default;
};

}  // namespace

bool Graph::begin_run(std::size_t workers) noexcept {
  if (std::exchange(ran_, true)) return false;
  begun_ns_.store(to_ns(clock_.now()), std::memory_order_relaxed);
  workers_.store(workers, std::memory_order_release);
  return true;
}

void Graph::name_family(std::span<Stage* const> replicas) {
  if (replicas.empty()) return;
  std::string_view common = replicas.front()->name();
  for (const Stage* s : replicas) {
    const auto differ = std::mismatch(common.begin(), common.end(), s->name().begin(), s->name().end());
    common = common.substr(0, static_cast<std::size_t>(differ.first - common.begin()));
  }
  for (Stage* s : replicas) s->set_family(std::string(common));
}

bool Graph::may_connect(const InBase& in) {
  if (!in.connected()) return true;
  build_errors_.push_back("input " + port_name(in.owner(), in.name()) + " is connected twice");
  return false;
}

bool Graph::may_delay(const InBase& in, std::size_t delay, std::size_t replicas) {
  if (delay > 0 && delay % replicas == 0) return true;
  const std::string why =
      delay == 0 ? " needs a delay of at least 1" : " needs a delay that is a multiple of its replicas";
  build_errors_.push_back("feedback into " + port_name(in.owner(), in.name()) + why);
  return false;
}

void Graph::check_spec(const OutBase& out, const InBase& in, const EdgeSpec& spec) {
  if (spec.capacity > 0) return;
  build_errors_.push_back("edge " + port_name(out.owner(), out.name()) + " -> " + port_name(in.owner(), in.name()) +
                          " has no capacity");
}

std::size_t Graph::index_of(const Stage& stage) const {
  const auto at = std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) { return s.get() == &stage; });
  ENAMEL_CHECK(at != stages_.end(), "a port of a stage that is not of this graph");
  return static_cast<std::size_t>(at - stages_.begin());
}

Result<void> Graph::validate() const {
  if (!build_errors_.empty()) return fail(ErrorCode::kInternal, build_errors_.front());
  ENAMEL_TRY(validate_ports());
  return validate_flow();
}

Result<void> Graph::validate_ports() const {
  std::set<std::string> names;
  for (const auto& s : stages_) {
    if (!names.insert(s->name()).second) return fail(ErrorCode::kInternal, "two stages are named '" + s->name() + "'");
    const bool is_source = s->as_source() != nullptr;
    if (is_source != s->ins().empty()) {
      return fail(ErrorCode::kInternal, "stage '" + s->name() + "': sources have no inputs and all others have some");
    }
    if (!s->ins().empty() && std::all_of(s->ins().begin(), s->ins().end(), [](auto* i) { return i->is_feedback(); })) {
      return fail(ErrorCode::kInternal, "stage '" + s->name() + "' has feedback inputs only: nothing paces it");
    }
    for (const InBase* in : s->ins()) {
      if (!in->connected())
        return fail(ErrorCode::kInternal, "input " + port_name(*s, in->name()) + " is not connected");
    }
    for (const OutBase* out : s->outs()) {
      if (!out->connected() && !out->ignored()) {
        return fail(ErrorCode::kInternal,
                    "output " + port_name(*s, out->name()) + " is not connected; call ignore() if nobody needs it");
      }
    }
  }
  return {};
}

std::vector<Stage*> Graph::topological_order() const {
  std::vector<std::size_t> waits_for(stages_.size(), 0);
  for (const auto& e : edges_) {
    if (e->delay() == 0) ++waits_for[index_of(e->to())];
  }
  std::vector<Stage*> order;
  std::vector<bool> placed(stages_.size(), false);
  for (bool progress = true; progress;) {
    progress = false;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
      if (placed[i] || waits_for[i] > 0) continue;
      placed[i] = true;
      progress = true;
      order.push_back(stages_[i].get());
      for (const auto& e : edges_) {
        if (e->delay() == 0 && &e->from() == stages_[i].get()) --waits_for[index_of(e->to())];
      }
    }
  }
  return order;
}

Result<void> Graph::validate_flow() const {
  const std::vector<Stage*> order = topological_order();
  if (order.size() != stages_.size()) {
    const auto lost = std::find_if(stages_.begin(), stages_.end(), [&](const auto& s) {
      return std::find(order.begin(), order.end(), s.get()) == order.end();
    });
    return fail(ErrorCode::kInternal, "stage '" + (*lost)->name() + "' lies on or behind a cycle without a delay edge");
  }
  std::vector<Origin> origin(stages_.size());
  const auto carried = [&](const EdgeBase& e) {
    Origin o = origin[index_of(e.from())];
    if (e.spec().on_full == OnFull::kKeepLatest) o.lossy.insert(&e);
    return o;
  };
  for (Stage* s : order) {
    Origin& mine = origin[index_of(*s)];
    if (s->as_source() != nullptr) mine.source = s;
    bool first = true;
    for (const auto& e : edges_) {
      if (&e->to() != s || e->delay() > 0) continue;
      if (first) mine = carried(*e);
      if (mine != carried(*e)) {
        return fail(
            ErrorCode::kInternal,
            "stage '" + s->name() + "' joins paths of different sources or losses: they never carry the same bursts");
      }
      first = false;
    }
  }
  for (const auto& e : edges_) {
    if (e->delay() > 0 && carried(*e) != origin[index_of(e->to())]) {
      return fail(ErrorCode::kInternal,
                  "feedback into " + port_name(e->to(), e->to_port()) + " comes from a path of another source or loss");
    }
  }
  return {};
}

}  // namespace enamel::flow
