// What pieces tell each other about their shifts: min-sum messages in whole numbers, so that every compiler and every
// vector width gives the same bits, and sixteen states fit one register.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace enamel::algo {

/// Negative log probability in steps of 1/64 nat; nats in [0, 500].
using Cost = std::int16_t;
[[nodiscard]] constexpr Cost to_cost(float nats) noexcept { return static_cast<Cost>(nats * 64 + 0.5F); }

/// Shifts of a piece, from its component's lowest on.
inline constexpr std::size_t kOrderStates = 16;
struct OrderCosts {
  alignas(32) std::array<Cost, kOrderStates> of{};
};

/// What a piece's partner beyond a gap thinks of each shift: state j fits partner state j - lean; a greater difference
/// costs `above`, a smaller one `below`.
struct GapCosts {
  std::int32_t lean = 0;
  Cost above = 0, below = 0;
};

[[nodiscard]] Cost least(const OrderCosts& costs) noexcept;

/// Along a surface: own[k] + min(in[k], min(in) + jump), less its own minimum so that sums stay small. `out` may be
/// `in`. |values| of in and own up to 60 nats; so are those of out.
void pass_joined(const OrderCosts& in, const OrderCosts& own, Cost jump, OrderCosts& out) noexcept;

/// Across a gap: own[j] + min over i of in[i] + gap(j - i), less its own minimum.
void pass_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out) noexcept;

/// Running mean of `own` and of what came before, each less its minimum: own + memory (min(before, most) - own).
/// memory in [0, 0.99].
void blend(const OrderCosts& before, const OrderCosts& own, float memory, Cost most, OrderCosts& out) noexcept;

}  // namespace enamel::algo
