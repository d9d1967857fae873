#include "pipeline/flow/bottleneck.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace enamel::flow {
namespace {

// What is worth a word in one line for a person: chosen for reading, decides nothing else.
constexpr double kWorthTelling = 0.2;
// Sources that wait for bursts more than half of the run set its rate.
constexpr double kStarved = 0.5;

double share(std::int64_t ns, const GraphSnapshot& s) {
  return s.elapsed_ns > 0 ? static_cast<double>(ns) / static_cast<double>(s.elapsed_ns) : 0;
}

const EdgeSnapshot* longest(const GraphSnapshot& s, const std::string& stage, std::string EdgeSnapshot::*end,
                            std::int64_t EdgeSnapshot::*ns) {
  const EdgeSnapshot* out = nullptr;
  for (const EdgeSnapshot& e : s.edges) {
    if (e.*end == stage && e.*ns > 0 && (out == nullptr || e.*ns > out->*ns)) out = &e;
  }
  return out;
}

std::string waits_for(const StageSnapshot& stage, const GraphSnapshot& s) {
  const StageTimes& t = stage.time_ns;
  const std::int64_t most = std::max({t.waiting, t.blocked, t.ready});
  if (most <= 0) return {};
  if (most == t.ready) return "a worker";
  if (most == t.blocked) {
    const EdgeSnapshot* e = longest(s, stage.name, &EdgeSnapshot::from, &EdgeSnapshot::blocked_ns);
    return e != nullptr ? "room in " + e->to : "room";
  }
  const EdgeSnapshot* e = longest(s, stage.name, &EdgeSnapshot::to, &EdgeSnapshot::awaited_ns);
  return e != nullptr ? e->from : "bursts";
}

/// A stage, or the replicas of one.
struct Family {
  std::string name;
  std::set<std::string> members;
  std::int64_t worked_ns = 0;
  /// Share of the time that each of them is busy.
  [[nodiscard]] double busy(const GraphSnapshot& s) const {
    return share(worked_ns, s) / static_cast<double>(members.size());
  }
};

std::vector<Family> families_of(const GraphSnapshot& s) {
  std::vector<Family> out;
  for (const StageSnapshot& stage : s.stages) {
    if (stage.is_source) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const Family& f) { return f.name == stage.family; });
    if (at == out.end()) at = out.insert(at, Family{.name = stage.family, .members = {}});
    at->members.insert(stage.name);
    at->worked_ns += stage.time_ns.running;
  }
  return out;
}

/// "its input is full", "fuse waits for it": what the neighbours' times say of the one that sets the rate.
std::vector<std::string> effects_of(const Family& family, const GraphSnapshot& s) {
  const auto hands_on = [&](const std::string& stage) {  // a sink waits by its nature
    return std::any_of(s.edges.begin(), s.edges.end(),
                       [&](const EdgeSnapshot& e) { return e.from == stage && e.delay == 0; });
  };
  std::vector<std::string> out;
  std::set<std::string> waiting;
  double full = 0;
  for (const EdgeSnapshot& e : s.edges) {
    if (e.delay > 0) continue;
    if (family.members.contains(e.to)) full = std::max(full, share(e.blocked_ns, s));
    if (family.members.contains(e.from) && hands_on(e.to) && share(e.awaited_ns, s) > kWorthTelling)
      waiting.insert(e.to);
  }
  if (full > kWorthTelling) out.emplace_back("its input is full");
  if (!waiting.empty())
    out.push_back(fmt::format("{} {} for it", fmt::join(waiting, " and "), waiting.size() > 1 ? "wait" : "waits"));
  return out;
}

}  // namespace

std::vector<StageLoad> loads_of(const GraphSnapshot& s) {
  std::vector<StageLoad> loads;
  for (const StageSnapshot& stage : s.stages) {
    const StageTimes& t = stage.time_ns;
    StageLoad load{
        .name = stage.name,
        .rate_hz = s.elapsed_ns > 0 ? static_cast<double>(stage.out) / (1e-9 * static_cast<double>(s.elapsed_ns)) : 0,
        .busy = share(t.running, s),
        .waits_input = share(t.waiting, s),
        .waits_room = share(t.blocked, s),
        .waits_worker = share(t.ready, s),
        .waits_for = waits_for(stage, s)};
    for (const EdgeSnapshot& e : s.edges) {
      if (e.to != stage.name || e.delay > 0 || !e.is_lossless) continue;
      load.queue_depth += e.depth;
      load.queue_high_water += static_cast<std::uint64_t>(std::max<std::int64_t>(e.high_water, 0));
      load.queue_capacity += e.capacity;
    }
    loads.push_back(std::move(load));
  }
  return loads;
}

Bottleneck bottleneck_of(const GraphSnapshot& s) {
  const std::vector<Family> families = families_of(s);
  if (families.empty() || s.elapsed_ns <= 0 || s.workers == 0) return {{}, "none: nothing has run yet"};
  const Family& busiest = *std::max_element(families.begin(), families.end(),
                                            [&](const Family& a, const Family& b) { return a.busy(s) < b.busy(s); });
  const Family& most = *std::max_element(families.begin(), families.end(),
                                         [](const Family& a, const Family& b) { return a.worked_ns < b.worked_ns; });
  std::int64_t worked_ns = 0, starved_ns = 0;
  for (const StageSnapshot& stage : s.stages) {
    worked_ns += stage.time_ns.running;
    if (stage.is_source) starved_ns = std::max(starved_ns, stage.time_ns.waiting);
  }
  const double busy = busiest.busy(s);
  if (const double starved = share(starved_ns, s); starved > kStarved) {
    return {{},
            fmt::format("none: the stages wait for bursts {:.0f} % of the time; the busiest is {} with {:.0f} %",
                        100 * starved, busiest.name, 100 * busy)};
  }
  const double workers = share(worked_ns, s) / static_cast<double>(s.workers);
  if (workers >= busy) {
    const std::string each = s.workers > 1 ? fmt::format("all {} are", s.workers) : "the one is";
    return {"workers",
            fmt::format("workers: {} busy {:.0f} % of the time, {:.0f} % of it with {}", each, 100 * workers,
                        100 * static_cast<double>(most.worked_ns) / static_cast<double>(worked_ns), most.name)};
  }
  std::vector<std::string> parts{fmt::format("busy {:.0f} % of the time", 100 * busy)};
  for (std::string& effect : effects_of(busiest, s)) parts.push_back(std::move(effect));
  return {busiest.name, fmt::format("{}: {}", busiest.name, fmt::join(parts, ", "))};
}

}  // namespace enamel::flow
