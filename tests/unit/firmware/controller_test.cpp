#include "firmware/control/controller.hpp"

#include <gmock/gmock.h>

#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ProbeState;
using proto::ReplyStatus;

class Controller : public testing::Test, public ControlRig {};

TEST_F(Controller, boots_through_self_test_to_idle) {
  EXPECT_EQ(state(), ProbeState::kBoot);
  controller.boot(now);
  EXPECT_EQ(state(), ProbeState::kSelftest);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kIdle);
  EXPECT_FALSE(lamp.enabled());
}

TEST_F(Controller, warms_up_and_scans_for_the_host_that_holds_it) {
  scanning();
  EXPECT_EQ(state(), ProbeState::kScanning);
  EXPECT_TRUE(lamp.enabled());
  EXPECT_EQ(acquisition.last_session.id.value, 7U);
}

TEST_F(Controller, stays_in_warmup_until_the_tip_is_warm) {
  temperatures.tip_cc = 3000;
  ready();
  EXPECT_EQ(state(), ProbeState::kWarmup);
  temperatures.tip_cc = 3500;
  tick();
  EXPECT_EQ(state(), ProbeState::kReady);
}

TEST_F(Controller, expired_command_is_refused_and_not_executed) {
  ready();
  proto::Command c;
  c.cmd_id = 100;
  c.client_id = 1;
  c.opcode = Opcode::kScanStart;
  c.arg_i[0] = 7;
  c.deadline_ns = static_cast<std::uint64_t>(to_ns(now)) - 1;
  EXPECT_EQ(send(c).status, ReplyStatus::kExpired);
  EXPECT_EQ(acquisition.scans, 0);
  c.cmd_id = 101;
  c.deadline_ns = static_cast<std::uint64_t>(to_ns(now)) + 1000;
  EXPECT_EQ(send(c).status, ReplyStatus::kOk);
}

TEST_F(Controller, repeated_command_gets_its_first_answer_and_is_not_executed_again) {
  ready();
  proto::Command c;
  c.cmd_id = 100;
  c.client_id = 1;
  c.opcode = Opcode::kScanStart;
  c.arg_i[0] = 7;
  EXPECT_EQ(send(c), send(c));
  EXPECT_EQ(acquisition.scans, 1);
  send(Opcode::kScanStop);
  tick();
  EXPECT_EQ(send(c).status, ReplyStatus::kOk);  // late duplicate: the light stays off
  EXPECT_EQ(state(), ProbeState::kReady);
  EXPECT_EQ(acquisition.scans, 1);
}

TEST_F(Controller, remembers_sixty_four_replies) {
  ready();
  proto::Command c;
  c.cmd_id = 1000;
  c.client_id = 1;
  c.opcode = Opcode::kScanStart;
  c.arg_i[0] = 7;
  send(c);
  for (int i = 0; i < 63; ++i) send(Opcode::kPing);
  send(c);
  EXPECT_EQ(acquisition.scans, 1);
  EXPECT_EQ(send(c).status, ReplyStatus::kOk);
}

TEST_F(Controller, only_the_holder_of_the_lease_commands) {
  ready();
  EXPECT_EQ(send(Opcode::kScanStart, 2, 9).status, ReplyStatus::kNotOwner);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kBusy);
  EXPECT_EQ(send(Opcode::kPing, 2).status, ReplyStatus::kOk);
  send(Opcode::kSessionClose, 1);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kOk);
}

TEST_F(Controller, safe_off_works_for_anyone_in_every_state) {
  scanning();
  EXPECT_EQ(send(Opcode::kSafeOff, 99).status, ReplyStatus::kOk);
  EXPECT_EQ(state(), ProbeState::kSafe);
  EXPECT_FALSE(lamp.enabled());
  EXPECT_EQ(send(Opcode::kSafeOff, 98).status, ReplyStatus::kOk);
  EXPECT_EQ(send(Opcode::kScanStart, 1, 7).status, ReplyStatus::kBadState);
}

TEST_F(Controller, an_update_is_kept_out_from_the_start_of_a_scan_to_its_end) {
  ready();
  EXPECT_FALSE(gate.scan_open);
  EXPECT_EQ(send(Opcode::kScanStart, 1, 7).status, ReplyStatus::kOk);
  EXPECT_TRUE(gate.scan_open);
  send(Opcode::kScanPause);
  tick();
  ASSERT_EQ(state(), ProbeState::kPaused);
  EXPECT_TRUE(gate.scan_open) << "the session is still open";
  send(Opcode::kScanStop);
  tick();
  ASSERT_EQ(state(), ProbeState::kReady);
  EXPECT_FALSE(gate.scan_open);
  send(Opcode::kScanStart, 1, 8);
  ASSERT_TRUE(gate.scan_open);
  send(Opcode::kSafeOff);
  EXPECT_FALSE(gate.scan_open);
}

TEST_F(Controller, no_scan_begins_while_firmware_is_written) {
  ready();
  gate.update = true;
  EXPECT_EQ(send(Opcode::kScanStart, 1, 7).status, ReplyStatus::kBusy) << "before the next tick";
  EXPECT_EQ(state(), ProbeState::kReady);
  tick();
  EXPECT_EQ(state(), ProbeState::kUpdating);
  EXPECT_FALSE(lamp.enabled());
  EXPECT_EQ(send(Opcode::kScanStart, 1, 7).status, ReplyStatus::kBadState);
  EXPECT_EQ(send(Opcode::kWarmup).status, ReplyStatus::kBadState);
  EXPECT_EQ(acquisition.scans, 0);
  gate.update = false;
  tick();
  EXPECT_EQ(state(), ProbeState::kIdle);
}

TEST_F(Controller, safe_is_latched_until_a_self_test_passes) {
  scanning();
  send(Opcode::kSafeOff);
  for (int i = 0; i < 100; ++i) {
    send(Opcode::kPing);
    tick(100);
  }
  EXPECT_EQ(state(), ProbeState::kSafe);
  EXPECT_EQ(send(Opcode::kSelftest).status, ReplyStatus::kOk);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kIdle);
}

TEST_F(Controller, silent_host_pauses_the_scan_and_the_light_is_off_within_three_seconds) {
  scanning();
  const HostTime last_word = now;
  while (lamp.enabled() && now < last_word + Nanoseconds{10'000'000'000}) tick(10);
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_LE(now - last_word, Nanoseconds{3'000'000'000});
  EXPECT_TRUE(told(602));
}

TEST_F(Controller, silent_host_pauses_even_when_the_burst_under_way_never_ends) {
  scanning();
  acquisition.drains_at_once = false;
  const HostTime last_word = now;
  while (lamp.enabled() && now < last_word + Nanoseconds{10'000'000'000}) tick(10);
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_LE(now - last_word, Nanoseconds{3'000'000'000});
}

TEST_F(Controller, any_command_renews_the_lease) {
  scanning();
  for (int i = 0; i < 20; ++i) {
    tick(2000);
    send(Opcode::kPing);
  }
  EXPECT_EQ(state(), ProbeState::kScanning);
}

TEST_F(Controller, another_host_takes_over_after_the_lease_is_lost) {
  scanning();
  for (int i = 0; i < 400; ++i) tick(10);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kOk);
  EXPECT_EQ(send(Opcode::kWarmup, 2).status, ReplyStatus::kOk);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(send(Opcode::kScanStart, 2, 7).status, ReplyStatus::kOk);
  EXPECT_EQ(acquisition.last_session.epoch, 2U);  // same number, another session
}

TEST_F(Controller, the_same_host_continues_its_session_after_a_pause) {
  scanning();
  send(Opcode::kScanPause);
  tick();
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_FALSE(lamp.enabled());
  send(Opcode::kScanStart, 1, 7);
  EXPECT_EQ(acquisition.last_session.epoch, 1U);
}

TEST_F(Controller, pause_finishes_the_burst_under_way_first) {
  scanning();
  acquisition.drains_at_once = false;
  send(Opcode::kScanPause);
  tick();
  EXPECT_EQ(state(), ProbeState::kScanning);
  EXPECT_EQ(acquisition.drains, 1);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kPaused);
}

TEST_F(Controller, fault_retries_three_times_with_back_off_then_waits) {
  scanning();
  acquisition.end(AcquisitionPhase::kFailed, ReplyStatus::kCamTimeout);
  tick();
  EXPECT_EQ(state(), ProbeState::kFault);
  EXPECT_EQ(controller.fault_mask(), 1U << 2U);
  EXPECT_TRUE(told(203));
  for (const int delay_ms : {500, 1000, 2000}) {
    tick(delay_ms - 20);
    EXPECT_EQ(state(), ProbeState::kFault);
    tick(20);
    EXPECT_EQ(state(), ProbeState::kSelftest);
    acquisition.end(AcquisitionPhase::kFailed, ReplyStatus::kCamTimeout);
    tick(10);
  }
  for (int i = 0; i < 100; ++i) tick(1000);
  EXPECT_EQ(state(), ProbeState::kFault);
}

TEST_F(Controller, stuck_led_and_over_temperature_lead_to_safe) {
  scanning();
  acquisition.end(AcquisitionPhase::kFailed, ReplyStatus::kLedStuck, true);
  tick();
  EXPECT_EQ(state(), ProbeState::kSafe);
  EXPECT_TRUE(told(502));
  ControlRig hot;
  hot.scanning();
  hot.temperatures.tip_cc = 4101;
  hot.tick();
  EXPECT_EQ(hot.state(), ProbeState::kSafe);
  EXPECT_FALSE(hot.lamp.enabled());
}

TEST_F(Controller, end_of_the_source_waits_for_the_publisher_then_tells_the_final_counts) {
  scanning();
  ledger.begin(acquisition.last_session, 2);
  ledger.emit(acquisition.last_session);
  acquisition.end(AcquisitionPhase::kEnded);
  tick();
  EXPECT_FALSE(lamp.enabled());
  EXPECT_FALSE(told(proto::kEventSessionEnded));
  ledger.drop(acquisition.last_session, proto::DropReason::kQueueFull);
  tick();
  ASSERT_TRUE(told(proto::kEventSessionEnded));
  EXPECT_EQ(notices.back().text, "session 7 ended: begun=2 emitted=1 dropped=1 queue_full=1");
  EXPECT_EQ(state(), ProbeState::kIdle);
  EXPECT_FALSE(controller.session_closed());
  send(Opcode::kSessionClose);
  EXPECT_TRUE(controller.session_closed());
}

TEST_F(Controller, single_bursts_end_by_themselves) {
  ready();
  send(Opcode::kSingleBurst, 1, 5);
  EXPECT_EQ(acquisition.last_limit, 5U);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kReady);
}

TEST_F(Controller, refuses_what_makes_no_sense) {
  ready();
  EXPECT_EQ(send(Opcode::kScanStart, 1, 0).status, ReplyStatus::kBadArg);
  EXPECT_EQ(send(Opcode::kScanStart, 1, -1).status, ReplyStatus::kBadArg);
  EXPECT_EQ(send(Opcode::kSingleBurst, 1, 1'000'000).status, ReplyStatus::kBadArg);
  EXPECT_EQ(send(Opcode::kScanPause).status, ReplyStatus::kBadState);
  EXPECT_EQ(send(Opcode::kFactoryReset).status, ReplyStatus::kUnknownOp);
  EXPECT_EQ(send(static_cast<Opcode>(0x77)).status, ReplyStatus::kUnknownOp);
}

}  // namespace
}  // namespace enamel::fw::test
