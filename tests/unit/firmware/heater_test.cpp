// The tip's heater in a closed loop around a MODEL of the tip, its parameters drawn at random.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/control/heater_loop.hpp"
#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::ReplyStatus;

/// One heat capacity, one loss, a thermistor that lags.
struct TipModel {
  double ambient_c = 25, capacity_j_k = 5, loss_w_k = 0.04, full_w = 2, lag_s = 1.5;
  double tip_c = 25, thermistor_c = 25;

  void step(double power, double dt) {
    tip_c += (power * full_w - loss_w_k * (tip_c - ambient_c)) / capacity_j_k * dt;
    thermistor_c += (tip_c - thermistor_c) / lag_s * dt;
  }
  [[nodiscard]] std::int16_t reading() const { return static_cast<std::int16_t>(std::lround(100 * thermistor_c)); }
};

TipModel drawn(std::mt19937_64& random) {
  const auto in = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  TipModel m;
  m.ambient_c = in(16, 30);
  m.capacity_j_k = in(2.5, 5);
  m.loss_w_k = in(0.01, 0.05);
  m.full_w = in(2, 3);
  m.lag_s = in(0.3, 2.5);
  m.tip_c = m.thermistor_c = m.ambient_c;
  return m;
}

struct Course {
  double reached_s = 1e9, highest_c = 0, worst_late_k = 0;
  std::optional<ReplyStatus> fault;
};

/// Three minutes; after two of them a breath of cold air.
Course heat(TipModel tip, double set_point_c = 37, const HeaterConfig& config = {}) {
  HeaterLoop loop(config);
  Course course;
  const auto set_point = static_cast<std::int16_t>(std::lround(100 * set_point_c));
  constexpr double kDt = 0.02;
  for (int i = 0; i < 9000; ++i) {
    const double t = i * kDt;
    const auto now = host_time(static_cast<std::int64_t>(1e9 * t));
    if (i == 6000) tip.tip_c -= 3;
    tip.step(1e-3 * loop.step(set_point, tip.reading(), now), kDt);
    if (tip.tip_c >= set_point_c - 1) course.reached_s = std::min(course.reached_s, t);
    course.highest_c = std::max(course.highest_c, tip.tip_c);
    const bool settled = (t > 90 && t < 119) || t > 165;
    if (settled) course.worst_late_k = std::max(course.worst_late_k, std::abs(tip.tip_c - set_point_c));
  }
  course.fault = loop.fault();
  return course;
}

TEST(HeaterLoop, warms_any_tip_in_time_and_holds_it_within_a_kelvin) {
  std::mt19937_64 random(20261128);
  for (int i = 0; i < 200; ++i) {
    const TipModel tip = drawn(random);
    const Course c = heat(tip);
    EXPECT_FALSE(c.fault.has_value()) << i;
    EXPECT_LT(c.reached_s, 50 * (tip.full_w > 2.3 || tip.capacity_j_k < 4 ? 1.0 : 1.5)) << i;
    EXPECT_LT(c.highest_c, 38.5) << i << ": the patient feels the overshoot";
    EXPECT_LT(c.worst_late_k, 1) << i;
  }
}

/// Negative control: a loop that leans on its integral overshoots.
TEST(HeaterLoop, a_greedy_integral_is_seen_to_overshoot) {
  HeaterConfig greedy;
  greedy.proportional = 0.05;
  greedy.integral = 0.1;
  EXPECT_GT(heat({}, 37, greedy).highest_c, 38.5);
}

TEST(HeaterLoop, never_heats_past_the_highest_set_point) {
  EXPECT_LT(heat({}, 45).highest_c, 40.5) << "asked for 45, taken as 39";
  HeaterLoop loop;
  EXPECT_EQ(loop.step(4500, 4100, host_time(0)), 0) << "cut off at 41 whatever was asked for";
}

TEST(HeaterLoop, open_heater_is_told_after_twenty_seconds_and_not_before) {
  TipModel cold;
  cold.full_w = 0;
  HeaterLoop loop;
  int i = 0;
  for (; i < 3000 && !loop.fault(); ++i) {
    cold.step(0, 0.02);
    static_cast<void>(loop.step(3700, cold.reading(), host_time(std::int64_t{i} * 20'000'000)));
  }
  EXPECT_EQ(loop.fault(), ReplyStatus::kHeaterOpen);
  EXPECT_GT(i, 1000);
  EXPECT_LT(i, 1200);
  EXPECT_EQ(loop.step(3700, 2500, host_time(100'000'000'000)), 0);
  EXPECT_EQ(loop.step(std::nullopt, 2500, host_time(101'000'000'000)), 0);
  EXPECT_GT(loop.step(3700, 2500, host_time(102'000'000'000)), 0) << "forgotten when it was switched off";
}

TEST(HeaterLoop, without_a_thermistor_there_is_no_heat) {
  HeaterLoop loop;
  EXPECT_GT(loop.step(3700, 2500, host_time(0)), 0);
  EXPECT_EQ(loop.step(3700, std::nullopt, host_time(10'000'000)), 0) << "at once, not with the next period";
  EXPECT_EQ(loop.fault(), ReplyStatus::kThermistor);
}

class HeaterControl : public testing::Test, public ControlRig {
 protected:
  HeaterControl() : ControlRig(with_heater()) {}
  static ControllerConfig with_heater() {
    ControllerConfig config;
    config.has_heater = true;
    return config;
  }
};

TEST_F(HeaterControl, heats_for_the_host_that_holds_it_and_for_nobody_else) {
  boot();
  EXPECT_FALSE(controller.heating().has_value());
  send(proto::Opcode::kSessionOpen);
  EXPECT_FALSE(controller.heating().has_value()) << "IDLE";
  send(proto::Opcode::kWarmup);
  EXPECT_EQ(controller.heating(), kUsualSetPointCc);
  tick(2600);
  EXPECT_FALSE(controller.heating().has_value()) << "the host is gone";
}

TEST_F(HeaterControl, takes_a_set_point_within_bounds) {
  scanning();
  proto::Command c;
  c.client_id = 1;
  c.opcode = proto::Opcode::kSetHeater;
  const auto set = [&](std::int64_t on, double celsius) {
    c.cmd_id = next_id++;
    c.arg_i[0] = on;
    c.arg_f[0] = celsius;
    return send(c).status;
  };
  EXPECT_EQ(set(1, 36.5), ReplyStatus::kOk);
  EXPECT_EQ(controller.heating(), std::int16_t{3650});
  EXPECT_EQ(set(1, 39.5), ReplyStatus::kBadArg);
  EXPECT_EQ(set(1, std::nan("")), ReplyStatus::kBadArg);
  EXPECT_EQ(controller.heating(), std::int16_t{3650});
  EXPECT_EQ(set(0, 0), ReplyStatus::kOk);
  EXPECT_FALSE(controller.heating().has_value());
}

TEST_F(HeaterControl, is_off_in_safe_and_in_fault) {
  scanning();
  send(proto::Opcode::kSafeOff);
  EXPECT_FALSE(controller.heating().has_value());
  ControlRig other{with_heater()};
  other.scanning();
  other.controller.heater_failed(ReplyStatus::kHeaterOpen, other.now);
  other.collect();
  EXPECT_EQ(other.state(), proto::ProbeState::kFault);
  EXPECT_FALSE(other.controller.heating().has_value());
  EXPECT_FALSE(other.lamp.enabled());
  EXPECT_TRUE(other.told(504));
}

TEST(WithoutHeater, the_command_is_refused) {
  ControlRig rig;
  rig.ready();
  EXPECT_EQ(rig.send(proto::Opcode::kSetHeater, 1, 1).status, ReplyStatus::kUnknownOp);
  EXPECT_FALSE(rig.controller.heating().has_value());
}

}  // namespace
}  // namespace enamel::fw::test
