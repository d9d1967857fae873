#include "pipeline/decode/unwrap/order_messages.hpp"

#include "pipeline/decode/unwrap/order_gap.hpp"

namespace enamel::pipeline {

void pass_gap(const OrderCosts& in, const OrderCosts& own, const GapCosts& gap, OrderCosts& out) noexcept {
  pass_gap_here(in, own, gap, out);
}

}  // namespace enamel::pipeline
