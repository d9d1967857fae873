// Messages of the labelling against their definitions, evaluated the slow way in double.
#include "pipeline/decode/unwrap/order_messages.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace enamel::pipeline {
namespace {

OrderCosts random_costs(std::mt19937& rng, int most_nats) {
  std::uniform_int_distribution<int> cost(0, most_nats * 64);
  OrderCosts out;
  for (Cost& c : out.of) c = static_cast<Cost>(cost(rng));
  return out;
}

TEST(OrderMessages, along_a_surface_a_jump_costs_its_price) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 200; ++trial) {
    const OrderCosts in = random_costs(rng, 60), own = random_costs(rng, 60);
    const auto jump = static_cast<Cost>(trial * 5);
    OrderCosts out;
    pass_joined(in, own, jump, out);
    std::array<double, kOrderStates> slow{};
    for (std::size_t j = 0; j < kOrderStates; ++j) {
      double best = 1e9;
      for (std::size_t i = 0; i < kOrderStates; ++i)
        best = std::min(best, static_cast<double>(in.of[i]) + (i == j ? 0 : jump));
      slow[j] = static_cast<double>(own.of[j]) + best - least(in);
    }
    for (std::size_t j = 0; j < kOrderStates; ++j) ASSERT_EQ(static_cast<double>(out.of[j]), slow[j]) << trial;
  }
}

TEST(OrderMessages, across_a_gap_the_difference_has_a_price_of_either_sign) {
  std::mt19937 rng(2);
  std::uniform_int_distribution<int> leans(-20, 20), prices(0, 400);
  for (int trial = 0; trial < 400; ++trial) {
    const OrderCosts in = random_costs(rng, 60), own = random_costs(rng, 60);
    const GapCosts gap{leans(rng), static_cast<Cost>(prices(rng)), static_cast<Cost>(prices(rng))};
    OrderCosts out;
    pass_gap(in, own, gap, out);
    // The partner may also be wrong: nothing costs more than the dearer of the two.
    const double low = least(in), most = std::max(gap.above, gap.below);
    std::array<double, kOrderStates> slow{};
    for (int j = 0; j < kStates; ++j) {
      double best = low + most;
      for (int i = 0; i < kStates; ++i) {
        const int over = j - i - gap.lean;
        best = std::min(best, static_cast<double>(in.of[static_cast<std::size_t>(i)]) +
                                  (over > 0 ? gap.above : (over < 0 ? gap.below : 0)));
      }
      slow[static_cast<std::size_t>(j)] = static_cast<double>(own.of[static_cast<std::size_t>(j)]) + best - low;
    }
    for (std::size_t j = 0; j < kOrderStates; ++j) ASSERT_EQ(static_cast<double>(out.of[j]), slow[j]) << trial;
  }
}

TEST(OrderMessages, seen_from_the_other_side_a_gap_has_the_prices_exchanged) {
  // One certain partner: every state of the other side pays what that pair costs, whichever side asks.
  const GapCosts gap{2, to_cost(3), to_cost(5)};
  for (int i = 3; i < 10; ++i) {
    for (int j = 3; j < 10; ++j) {
      OrderCosts left, right, forth, back;
      left.of.fill(to_cost(50)), right.of.fill(to_cost(50));
      left.of[static_cast<std::size_t>(i)] = right.of[static_cast<std::size_t>(j)] = 0;
      pass_gap(left, {}, gap, forth);
      pass_gap(right, {}, {-gap.lean, gap.below, gap.above}, back);
      EXPECT_EQ(forth.of[static_cast<std::size_t>(j)] - least(forth),
                back.of[static_cast<std::size_t>(i)] - least(back));
    }
  }
}

TEST(OrderMessages, blend_is_a_mean_to_a_step) {
  std::mt19937 rng(3);
  for (const float memory : {0.0F, 0.3F, 0.85F, 0.99F}) {
    const OrderCosts before = random_costs(rng, 60), unlevelled = random_costs(rng, 60);
    const Cost most = to_cost(27);
    OrderCosts own, out;
    level(CostPair(unlevelled), own);
    ASSERT_EQ(least(own), 0);
    blend(before, own, memory, most, out);
    for (std::size_t k = 0; k < kOrderStates; ++k) {
      const double was = std::min<int>(before.of[k] - least(before), most), is = unlevelled.of[k] - least(unlevelled);
      EXPECT_NEAR(out.of[k], static_cast<double>(memory) * was + (1 - static_cast<double>(memory)) * is, 1.2);
    }
  }
}

}  // namespace
}  // namespace enamel::pipeline
