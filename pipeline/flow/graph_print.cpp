#include <fmt/format.h>

#include "pipeline/flow/graph.hpp"

namespace enamel::flow {
namespace {

std::string stage_json(const StageSnapshot& s) {
  std::string rejected;
  for (const auto& [reason, count] : s.rejected) {
    rejected += (rejected.empty() ? "" : ", ") + json_quote(reason) + ": " + std::to_string(count);
  }
  return fmt::format(
      R"({{"name": {}, "state": "{}", "in": {}, "out": {}, "errors": {}, "degraded": {}, "discarded": {}, "last_id": {}, )"
      R"("rejected": {{{}}}, "service_ns": {{"count": {}, "mean": {:.1f}, "p50": {}, "p95": {}, "p99": {}, "max": {}}}}})",
      json_quote(s.name), to_string(s.state), s.in, s.out, s.errors, s.degraded, s.discarded, s.last_id, rejected,
      s.service_ns.count, s.service_ns.mean, s.service_ns.p50, s.service_ns.p95, s.service_ns.p99, s.service_ns.max);
}

std::string edge_json(const EdgeSnapshot& e) {
  return fmt::format(R"({{"name": {}, "pushed": {}, "popped": {}, "dropped": {}, "high_water": {}}})",
                     json_quote(e.name), e.pushed, e.popped, e.dropped, e.high_water);
}

}  // namespace

std::string to_json(const GraphSnapshot& snapshot) {
  std::string stages;
  for (const StageSnapshot& s : snapshot.stages) stages += (stages.empty() ? "" : ", ") + stage_json(s);
  std::string edges;
  for (const EdgeSnapshot& e : snapshot.edges) edges += (edges.empty() ? "" : ", ") + edge_json(e);
  return R"({"stages": [)" + stages + R"(], "edges": [)" + edges + "]}";
}

std::string Graph::mermaid() const {
  std::string out = "flowchart LR\n";
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    Stage& s = *stages_[i];
    const bool round = s.as_source() != nullptr || s.outs().empty();
    out += fmt::format("  s{}{}{}{}\n", i, round ? "([" : "[", s.name(), round ? "])" : "]");
  }
  for (const auto& e : edges_) {
    const std::size_t from = index_of(e->from());
    const std::size_t to = index_of(e->to());
    if (e->delay() > 0) {
      out += fmt::format("  s{} -. \"{}, delay {}\" .-> s{}\n", from, e->from_port(), e->delay(), to);
    } else if (e->spec().on_full == OnFull::kKeepLatest) {
      out += fmt::format("  s{} -. \"{}, latest\" .-> s{}\n", from, e->from_port(), to);
    } else {
      out += fmt::format("  s{} -- \"{}, {}\" --> s{}\n", from, e->from_port(), e->spec().capacity, to);
    }
  }
  return out;
}

GraphSnapshot Graph::snapshot() const {
  GraphSnapshot out;
  for (const auto& s : stages_) {
    const StageStats& st = std::as_const(*s).stats();
    out.stages.push_back({s->name(), st.state.load(std::memory_order_relaxed), st.in.value(), st.out.value(),
                          st.errors.value(), st.degraded.value(), st.discarded.value(),
                          st.last_id.load(std::memory_order_relaxed), st.rejected.snapshot(), st.service_ns.summary()});
  }
  for (const auto& e : edges_) {
    out.edges.push_back({e->from().name() + "." + e->from_port() + " -> " + e->to().name() + "." + e->to_port(),
                         e->stats().pushed.value(), e->stats().popped.value(), e->stats().dropped.value(),
                         e->stats().depth.max()});
  }
  return out;
}

}  // namespace enamel::flow
