#include "firmware/control/controller.hpp"

#include <gmock/gmock.h>

#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ProbeState;
using proto::ReplyStatus;

class Controller : public testing::Test, public ControlRig {};

TEST_F(Controller, BootsThroughSelfTestToIdle) {
  EXPECT_EQ(state(), ProbeState::kBoot);
  controller.boot(now);
  EXPECT_EQ(state(), ProbeState::kSelftest);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kIdle);
  EXPECT_FALSE(lamp.enabled());
}

TEST_F(Controller, WarmsUpAndScansForTheHostThatHoldsIt) {
  scanning();
  EXPECT_EQ(state(), ProbeState::kScanning);
  EXPECT_TRUE(lamp.enabled());
  EXPECT_EQ(acquisition.last_session.id.value, 7U);
}

TEST_F(Controller, StaysInWarmupUntilTheTipIsWarm) {
  temperatures.tip_cc = 3000;
  ready();
  EXPECT_EQ(state(), ProbeState::kWarmup);
  temperatures.tip_cc = 3500;
  tick();
  EXPECT_EQ(state(), ProbeState::kReady);
}

TEST_F(Controller, ExpiredCommandIsRefusedAndNotExecuted) {
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

TEST_F(Controller, RepeatedCommandGetsItsFirstAnswerAndIsNotExecutedAgain) {
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

TEST_F(Controller, RemembersSixtyFourReplies) {
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

TEST_F(Controller, OnlyTheHolderOfTheLeaseCommands) {
  ready();
  EXPECT_EQ(send(Opcode::kScanStart, 2, 9).status, ReplyStatus::kNotOwner);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kBusy);
  EXPECT_EQ(send(Opcode::kPing, 2).status, ReplyStatus::kOk);
  send(Opcode::kSessionClose, 1);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kOk);
}

TEST_F(Controller, SafeOffWorksForAnyoneInEveryState) {
  scanning();
  EXPECT_EQ(send(Opcode::kSafeOff, 99).status, ReplyStatus::kOk);
  EXPECT_EQ(state(), ProbeState::kSafe);
  EXPECT_FALSE(lamp.enabled());
  EXPECT_EQ(send(Opcode::kSafeOff, 98).status, ReplyStatus::kOk);
  EXPECT_EQ(send(Opcode::kScanStart, 1, 7).status, ReplyStatus::kBadState);
}

TEST_F(Controller, AnUpdateIsKeptOutFromTheStartOfAScanToItsEnd) {
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

TEST_F(Controller, NoScanBeginsWhileFirmwareIsWritten) {
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

TEST_F(Controller, SafeIsLatchedUntilASelfTestPasses) {
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

TEST_F(Controller, SilentHostPausesTheScanAndTheLightIsOffWithinThreeSeconds) {
  scanning();
  const HostTime last_word = now;
  while (lamp.enabled() && now < last_word + Nanoseconds{10'000'000'000}) tick(10);
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_LE(now - last_word, Nanoseconds{3'000'000'000});
  EXPECT_TRUE(told(602));
}

TEST_F(Controller, SilentHostPausesEvenWhenTheBurstUnderWayNeverEnds) {
  scanning();
  acquisition.drains_at_once = false;
  const HostTime last_word = now;
  while (lamp.enabled() && now < last_word + Nanoseconds{10'000'000'000}) tick(10);
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_LE(now - last_word, Nanoseconds{3'000'000'000});
}

TEST_F(Controller, AnyCommandRenewsTheLease) {
  scanning();
  for (int i = 0; i < 20; ++i) {
    tick(2000);
    send(Opcode::kPing);
  }
  EXPECT_EQ(state(), ProbeState::kScanning);
}

TEST_F(Controller, AnotherHostTakesOverAfterTheLeaseIsLost) {
  scanning();
  for (int i = 0; i < 400; ++i) tick(10);
  EXPECT_EQ(send(Opcode::kSessionOpen, 2).status, ReplyStatus::kOk);
  EXPECT_EQ(send(Opcode::kWarmup, 2).status, ReplyStatus::kOk);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(send(Opcode::kScanStart, 2, 7).status, ReplyStatus::kOk);
  EXPECT_EQ(acquisition.last_session.epoch, 2U);  // same number, another session
}

TEST_F(Controller, TheSameHostContinuesItsSessionAfterAPause) {
  scanning();
  send(Opcode::kScanPause);
  tick();
  EXPECT_EQ(state(), ProbeState::kPaused);
  EXPECT_FALSE(lamp.enabled());
  send(Opcode::kScanStart, 1, 7);
  EXPECT_EQ(acquisition.last_session.epoch, 1U);
}

TEST_F(Controller, PauseFinishesTheBurstUnderWayFirst) {
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

TEST_F(Controller, FaultRetriesThreeTimesWithBackOffThenWaits) {
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

TEST_F(Controller, StuckLedAndOverTemperatureLeadToSafe) {
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

TEST_F(Controller, EndOfTheSourceWaitsForThePublisherThenTellsTheFinalCounts) {
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

TEST_F(Controller, SingleBurstsEndByThemselves) {
  ready();
  send(Opcode::kSingleBurst, 1, 5);
  EXPECT_EQ(acquisition.last_limit, 5U);
  acquisition.end(AcquisitionPhase::kDone);
  tick();
  EXPECT_EQ(state(), ProbeState::kReady);
}

TEST_F(Controller, RefusesWhatMakesNoSense) {
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
