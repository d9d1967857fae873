// Trigger edges of the last few frames, put in order of time, with projector edges turned into numbered patterns.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "firmware/hal/edges.hpp"

namespace enamel::fw {

struct Strobe {
  DeviceTime t{};
  bool used = false;
};

/// A pattern's index counts T2 edges since the last T1 edge; without a T1 it runs on past 3 and fits nowhere.
struct Pattern {
  int index = 0;
  DeviceTime rise{};
  std::optional<DeviceTime> fall;
};

struct Gate {
  std::uint64_t burst_index = 0;
  DeviceTime t{};
};

class EdgeLog {
 public:
  /// Keeps edges for `memory` behind the newest time of interest.
  explicit EdgeLog(Nanoseconds memory) : memory_(memory) {}

  void push(const Edge& edge);
  /// Orders and interprets the edges up to `t`; those that come later for an earlier time are counted and ignored.
  void advance(DeviceTime t);

  [[nodiscard]] Strobe* nearest_strobe(DeviceTime t) noexcept;
  /// Patterns with the rising edge in [begin, end).
  [[nodiscard]] std::vector<Pattern> patterns_in(DeviceTime begin, DeviceTime end) const;
  /// True when a pattern that rose before `begin` was still lit after it.
  [[nodiscard]] bool lit_across(DeviceTime begin) const noexcept;
  [[nodiscard]] std::optional<Gate> take_gate(DeviceTime until);
  [[nodiscard]] std::uint64_t late_edges() const noexcept { return late_; }

 private:
  void interpret(const Edge& edge);

  Nanoseconds memory_;
  std::vector<Edge> pending_;  ///< sorted by time
  DeviceTime done_{DeviceTime::min()};
  std::deque<Strobe> strobes_;
  std::deque<Pattern> patterns_;
  std::deque<Gate> gates_;
  std::optional<int> last_index_;
  bool set_started_ = false;
  std::uint64_t late_ = 0;
};

}  // namespace enamel::fw
