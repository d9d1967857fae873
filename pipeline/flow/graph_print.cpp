#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/flow/bottleneck.hpp"
#include "pipeline/flow/graph.hpp"

namespace enamel::flow {
namespace {

double ms(double ns) { return 1e-6 * ns; }

std::string stage_json(const StageSnapshot& s, const StageLoad& load) {
  std::string rejected;
  for (const auto& [reason, count] : s.rejected) {
    rejected += (rejected.empty() ? "" : ", ") + json_quote(reason) + ": " + std::to_string(count);
  }
  const LogHistogram::Summary& t = s.service_ns;
  return fmt::format(
      R"({{"name": {}, "state": "{}", "in": {}, "out": {}, "errors": {}, "degraded": {}, "discarded": {}, "last_id": {}, )"
      R"("rejected": {{{}}}, "rate_hz": {:.3f}, )"
      R"("service_ms": {{"count": {}, "mean": {:.4f}, "p50": {:.4f}, "p95": {:.4f}, "p99": {:.4f}, "max": {:.4f}}}, )"
      R"("busy": {:.4f}, "waits": {{"input": {:.4f}, "room": {:.4f}, "worker": {:.4f}}}, "waits_for": {}, )"
      R"("queue": {{"depth": {}, "high_water": {}, "capacity": {}}}}})",
      json_quote(s.name), to_string(s.state), s.in, s.out, s.errors, s.degraded, s.discarded, s.last_id, rejected,
      load.rate_hz, t.count, ms(t.mean), ms(static_cast<double>(t.p50)), ms(static_cast<double>(t.p95)),
      ms(static_cast<double>(t.p99)), ms(static_cast<double>(t.max)), load.busy, load.waits_input, load.waits_room,
      load.waits_worker, json_quote(load.waits_for), load.queue_depth, load.queue_high_water, load.queue_capacity);
}

std::string edge_json(const EdgeSnapshot& e) {
  return fmt::format(
      R"({{"name": {}, "pushed": {}, "popped": {}, "dropped": {}, "depth": {}, "high_water": {}, "capacity": {}, )"
      R"("lossless": {}, "delay": {}}})",
      json_quote(e.name), e.pushed, e.popped, e.dropped, e.depth, e.high_water, e.capacity, e.is_lossless, e.delay);
}

EdgeSnapshot snapshot_of(const EdgeBase& e) {
  const EdgeStats& stats = e.stats();
  EdgeSnapshot out{.name = e.from().name() + "." + e.from_port() + " -> " + e.to().name() + "." + e.to_port(),
                   .from = e.from().name(),
                   .to = e.to().name(),
                   .capacity = e.spec().capacity,
                   .is_lossless = e.spec().on_full == OnFull::kBlock,
                   .delay = e.delay(),
                   .pushed = stats.pushed.value(),
                   .popped = stats.popped.value(),
                   .dropped = stats.dropped.value(),
                   .high_water = stats.depth.max(),
                   .awaited_ns = static_cast<std::int64_t>(stats.awaited_ns.value()),
                   .blocked_ns = static_cast<std::int64_t>(stats.blocked_ns.value())};
  if (!out.is_lossless) out.capacity = 1;
  const std::uint64_t gone = out.popped + out.dropped;  // read after `pushed`: may be ahead of it
  out.depth = out.pushed > gone ? out.pushed - gone : 0;
  return out;
}

StageTimes times_of(const StageStats& stats, std::int64_t now_ns) {
  std::array<std::int64_t, kStageStates> ns{};
  for (std::size_t i = 0; i < ns.size(); ++i) ns[i] = static_cast<std::int64_t>(stats.time_in_ns[i].value());
  const StageState state = stats.state.load(std::memory_order_relaxed);
  if (state != StageState::kIdle) {
    const std::int64_t present = now_ns - stats.since_ns.load(std::memory_order_relaxed);
    ns[static_cast<std::size_t>(state)] += std::max<std::int64_t>(present, 0);
  }
  const auto in = [&](StageState s) { return ns[static_cast<std::size_t>(s)]; };
  return {in(StageState::kRunning), in(StageState::kWaitingInput), in(StageState::kBlockedOutput),
          in(StageState::kReady)};
}

}  // namespace

std::string to_json(const GraphSnapshot& snapshot) {
  const std::vector<StageLoad> loads = loads_of(snapshot);
  std::string stages;
  for (std::size_t i = 0; i < loads.size(); ++i)
    stages += (i == 0 ? "" : ", ") + stage_json(snapshot.stages[i], loads[i]);
  std::string edges;
  for (const EdgeSnapshot& e : snapshot.edges) edges += (edges.empty() ? "" : ", ") + edge_json(e);
  const Bottleneck bottleneck = bottleneck_of(snapshot);
  return fmt::format(
      R"({{"seconds": {:.3f}, "workers": {}, "bottleneck": {{"stage": {}, "words": {}}}, "stages": [{}], "edges": [{}]}})",
      1e-9 * static_cast<double>(snapshot.elapsed_ns), snapshot.workers, json_quote(bottleneck.stage),
      json_quote(bottleneck.words), stages, edges);
}

GraphSnapshot Graph::snapshot() const {
  GraphSnapshot out;
  out.workers = workers_.load(std::memory_order_acquire);
  const std::int64_t ended_ns = ended_ns_.load(std::memory_order_acquire);
  const std::int64_t now_ns = ended_ns >= 0 ? ended_ns : to_ns(clock_.now());
  if (out.workers > 0) out.elapsed_ns = now_ns - begun_ns_.load(std::memory_order_relaxed);
  for (const auto& s : stages_) {
    const StageStats& st = std::as_const(*s).stats();
    out.stages.push_back({s->name(), s->family(), s->as_source() != nullptr, st.state.load(std::memory_order_relaxed),
                          st.in.value(), st.out.value(), st.errors.value(), st.degraded.value(), st.discarded.value(),
                          st.last_id.load(std::memory_order_relaxed), st.rejected.snapshot(), st.service_ns.summary(),
                          times_of(st, now_ns)});
  }
  for (const auto& e : edges_) out.edges.push_back(snapshot_of(*e));
  return out;
}

}  // namespace enamel::flow
