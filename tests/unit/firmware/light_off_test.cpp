// Whatever ends a scan, the light is off in time: the controller's part of the table in docs/probe.md.
#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ProbeState;
using proto::ReplyStatus;

/// Ticks of 10 ms from the trouble on; a host that lives pings five times a second.
int ms_until_dark(ControlRig& rig, bool host_lives) {
  for (int ms = 0; ms <= 5'000; ms += 10) {
    if (!rig.lamp.enabled()) return ms;
    if (host_lives && ms % 200 == 0) rig.send(Opcode::kPing);
    rig.tick(10);
  }
  return 1'000'000;
}

struct Trouble {
  const char* name;
  int within_ms;
  ProbeState ends_in;
  bool host_lives;
  std::function<void(ControlRig&)> strike;
};

const Trouble kTroubles[] = {
    {"host dead", 3'000, ProbeState::kPaused, false, [](ControlRig&) {}},
    {"host dead while a burst never ends", 3'000, ProbeState::kPaused, false,
     [](ControlRig& r) { r.acquisition.drains_at_once = false; }},
    {"acquisition hangs", 3'000, ProbeState::kFault, true, [](ControlRig& r) { r.acquisition.hangs = true; }},
    {"projector error", 100, ProbeState::kFault, true,
     [](ControlRig& r) {
       r.acquisition.now = {AcquisitionPhase::kFailed, ReplyStatus::kProjSeqAbort, false};
     }},
    {"camera unplugged", 100, ProbeState::kFault, true,
     [](ControlRig& r) {
       r.acquisition.now = {AcquisitionPhase::kFailed, ReplyStatus::kCamDisconnected, false};
     }},
    {"LED stuck on", 100, ProbeState::kSafe, true,
     [](ControlRig& r) {
       r.acquisition.now = {AcquisitionPhase::kFailed, ReplyStatus::kLedStuck, true};
     }},
    {"tip too hot", 100, ProbeState::kSafe, true, [](ControlRig& r) { r.temperatures.tip_cc = 4110; }},
    {"processor too hot", 100, ProbeState::kSafe, true, [](ControlRig& r) { r.temperatures.soc_cc = 9010; }},
    {"SAFE_OFF from anyone", 100, ProbeState::kSafe, true, [](ControlRig& r) { r.send(Opcode::kSafeOff, 99); }},
    {"program ends", 100, ProbeState::kScanning, true, [](ControlRig& r) { r.controller.shut_down(); }},
};

TEST(LightOff, in_time_whatever_happens) {
  for (const Trouble& trouble : kTroubles) {
    ControlRig rig;
    rig.scanning();
    ASSERT_TRUE(rig.lamp.enabled()) << trouble.name;
    trouble.strike(rig);
    EXPECT_LE(ms_until_dark(rig, trouble.host_lives), trouble.within_ms) << trouble.name;
    EXPECT_EQ(rig.state(), trouble.ends_in) << trouble.name;
  }
}

/// Negative control: without trouble the light stays on.
TEST(LightOff, not_without_a_reason) {
  ControlRig rig;
  rig.scanning();
  EXPECT_GT(ms_until_dark(rig, true), 5'000);
}

TEST(LightOff, an_acquisition_that_hangs_gets_no_light_and_no_further_try_until_it_lives) {
  ControlRig rig;
  rig.scanning();
  rig.acquisition.hangs = true;
  EXPECT_LE(ms_until_dark(rig, true), 3'000);
  EXPECT_TRUE(rig.told(902));
  for (int i = 0; i < 1'000; ++i) {
    rig.tick(10);
    rig.light.want(true);  // as a thread would that hangs with the light wanted
    ASSERT_FALSE(rig.lamp.enabled()) << i;
    ASSERT_EQ(rig.state(), ProbeState::kFault);
  }
  EXPECT_GT(rig.controller.silence(), Nanoseconds{9'000'000'000}) << "nobody feeds the watchdog any more";
  rig.acquisition.hangs = false;
  rig.acquisition.end(AcquisitionPhase::kDone);
  rig.tick(10);
  EXPECT_EQ(rig.controller.silence(), Nanoseconds{});
  EXPECT_EQ(rig.state(), ProbeState::kSelftest) << "tried again";
}

}  // namespace
}  // namespace enamel::fw::test
