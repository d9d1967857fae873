// What segments tell each other about their shifts: min-sum messages in whole numbers, so that every compiler and every
// vector width gives the same bits, and sixteen states fit one register.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace enamel::pipeline {

/// Negative log probability in steps of 1/64 nat; nats in [0, 500].
using Cost = std::int16_t;
[[nodiscard]] constexpr Cost to_cost(float nats) noexcept {
  // To the nearest: half steps first, then half of them, rounded up.
  return static_cast<Cost>((static_cast<std::int32_t>(nats * 128) + 1) / 2);
}

/// layout: shifts of a segment, from its base on (order_windows.hpp).
inline constexpr std::size_t kOrderStates = 16;
inline constexpr auto kStates = static_cast<std::int32_t>(kOrderStates);  ///< the same, as shifts count
struct OrderCosts {
  alignas(32) std::array<Cost, kOrderStates> of{};
};

/// What a segment's partner beyond a gap thinks of each shift: state j fits partner state j - lean; a greater
/// difference costs `above`, a smaller one `below`.
struct GapCosts {
  std::int32_t lean = 0;
  Cost above = 0, below = 0;
};

/// Half of the states, in a register of every instruction set that we build for (a vector type of g++ and clang).
using CostHalf [[gnu::vector_size(16)]] = Cost;

struct CostPair {
  CostHalf low, high;

  explicit CostPair(const OrderCosts& costs) noexcept {
    std::memcpy(&low, costs.of.data(), sizeof low);
    std::memcpy(&high, costs.of.data() + kOrderStates / 2, sizeof high);
  }
  void store(OrderCosts& out) const noexcept {
    std::memcpy(out.of.data(), &low, sizeof low);
    std::memcpy(out.of.data() + kOrderStates / 2, &high, sizeof high);
  }
};

[[gnu::always_inline]] inline CostHalf lesser(CostHalf a, CostHalf b) noexcept { return a < b ? a : b; }

/// The least of all states, in every lane.
[[gnu::always_inline]] inline CostHalf least_everywhere(const CostPair& costs) noexcept {
  CostHalf m = lesser(costs.low, costs.high);
  m = lesser(m, __builtin_shufflevector(m, m, 4, 5, 6, 7, 0, 1, 2, 3));
  m = lesser(m, __builtin_shufflevector(m, m, 2, 3, 0, 1, 6, 7, 4, 5));
  return lesser(m, __builtin_shufflevector(m, m, 1, 0, 3, 2, 5, 4, 7, 6));
}

[[nodiscard, gnu::always_inline]] inline Cost least(const OrderCosts& costs) noexcept {
  return least_everywhere(CostPair(costs))[0];
}

// The messages one by one. Rows of segments are worked off with what these are made of, where they are compiled for the
// processor's instruction set (order_states-inl.h, order_gap.hpp).

/// Along a surface: own[k] + min(in[k] - min(in), jump). `out` may be `in`. in and own in [0, 200] nats.
void pass_joined(const OrderCosts& in, const OrderCosts& own, Cost jump, OrderCosts& out);

/// Across a gap: own[j] + min over i of in[i] - min(in) + gap(j - i). `out` may be `in`.
void pass_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out);

/// costs less their least.
void level(const CostPair& costs, OrderCosts& out);

/// Running mean of `own`, whose least is 0, and of what came before less its least: own + memory (min(before, most) -
/// own), to a step. memory in [0, 0.99]. own up to 200 nats, most up to 200.
void blend(const OrderCosts& before, const OrderCosts& own, float memory, Cost most, OrderCosts& out);

/// memory in 2^-15, as blended() takes it.
[[nodiscard]] constexpr Cost to_share(float memory) noexcept { return static_cast<Cost>(memory * 32768); }

[[nodiscard, gnu::always_inline]] inline CostPair mean_of(const OrderCosts& a, const OrderCosts& b) noexcept {
  CostPair mean(a);
  const CostPair other(b);
  mean.low = (mean.low + other.low) >> 1;
  mean.high = (mean.high + other.high) >> 1;
  return mean;
}

/// The cheapest state, the lowest of equals, and by how much every other is dearer, at most kImpossible less its cost.
struct Choice {
  std::int32_t state;
  Cost least, margin;
};

inline constexpr float kImpossibleNats = 60;  ///< layout: in place of a cost, above any that is one
inline constexpr Cost kImpossible = to_cost(kImpossibleNats);

[[nodiscard, gnu::always_inline]] inline Choice cheapest(CostPair costs) noexcept {
  const CostHalf low_states{0, 1, 2, 3, 4, 5, 6, 7}, high_states{8, 9, 10, 11, 12, 13, 14, 15};
  const CostHalf none = CostHalf{} + static_cast<Cost>(kOrderStates), impossible = CostHalf{} + kImpossible;
  const CostHalf first = least_everywhere(costs);
  CostPair place(costs);
  place.low = costs.low == first ? low_states : none;
  place.high = costs.high == first ? high_states : none;
  const CostHalf best = least_everywhere(place);
  costs.low = low_states == best ? impossible : costs.low;
  costs.high = high_states == best ? impossible : costs.high;
  const CostHalf second = least_everywhere(costs);
  return {best[0], first[0], static_cast<Cost>(second[0] - first[0])};
}

}  // namespace enamel::pipeline
