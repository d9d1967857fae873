#include "host/ingest/ingress_gate.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace enamel::host {
namespace {

TEST(IngressGate, sheds_the_oldest_and_hands_it_back) {
  IngressGate<int> gate(2, GatePolicy::kShedOldest);
  EXPECT_FALSE(gate.push(1));
  EXPECT_FALSE(gate.push(2));
  EXPECT_EQ(gate.push(3), 1);
  EXPECT_EQ(gate.pop(), 2);
  EXPECT_EQ(gate.pop(), 3);
}

TEST(IngressGate, lossless_push_waits_for_room) {
  IngressGate<int> gate(1, GatePolicy::kLossless);
  std::thread pusher([&] {
    for (int i = 0; i < 1000; ++i) EXPECT_FALSE(gate.push(i));
    gate.close();
  });
  int expected = 0;
  while (const auto item = gate.pop()) EXPECT_EQ(*item, expected++);
  EXPECT_EQ(expected, 1000);
  pusher.join();
}

TEST(IngressGate, closed_gate_gives_the_item_back_and_drains) {
  IngressGate<int> gate(4, GatePolicy::kShedOldest);
  EXPECT_FALSE(gate.push(1));
  gate.close();
  EXPECT_EQ(gate.push(2), 2);
  EXPECT_EQ(gate.pop(), 1);
  EXPECT_EQ(gate.pop(), std::nullopt);
}

TEST(IngressGate, every_item_comes_out_or_comes_back) {
  IngressGate<int> gate(3, GatePolicy::kShedOldest);
  int shed = 0;
  int taken = 0;
  std::thread popper([&] {
    while (gate.pop()) ++taken;
  });
  for (int i = 0; i < 20000; ++i) shed += gate.push(i).has_value() ? 1 : 0;
  gate.close();
  popper.join();
  EXPECT_EQ(shed + taken, 20000);
}

}  // namespace
}  // namespace enamel::host
