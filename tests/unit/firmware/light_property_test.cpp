// Whatever is commanded and whatever fails, in any order: light only where it is allowed, an event for every
// transition.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <random>

#include "tests/unit/firmware/control_fakes.hpp"

namespace enamel::fw::test {
namespace {

using proto::Opcode;
using proto::ProbeState;

constexpr std::array kOpcodes{Opcode::kPing,      Opcode::kSessionOpen, Opcode::kSessionClose, Opcode::kWarmup,
                              Opcode::kScanStart, Opcode::kScanPause,   Opcode::kScanStop,     Opcode::kSingleBurst,
                              Opcode::kSelftest,  Opcode::kSafeOff,     Opcode::kReboot,       Opcode::kSetLed};
constexpr std::array kEnds{AcquisitionPhase::kDone, AcquisitionPhase::kDone, AcquisitionPhase::kEnded,
                           AcquisitionPhase::kFailed};

void random_action(ControlRig& rig, std::mt19937_64& random) {
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  switch (pick(10)) {
    case 0:
    case 1:
    case 2:
    case 3: {
      const Opcode opcode = kOpcodes[pick(kOpcodes.size())];
      if (opcode == Opcode::kSafeOff && pick(30) != 0) return;
      rig.send(opcode, pick(12) == 0 ? 2U : 1U, static_cast<std::int64_t>(pick(4)));
      return;
    }
    case 4:
    case 5:
      rig.acquisition.end(kEnds[pick(kEnds.size())], proto::ReplyStatus::kCamTimeout, pick(400) == 0);
      return;
    case 6:
      rig.light.want(pick(2) == 0);  // an acquisition that asks for light at the wrong time
      return;
    case 7:
      rig.gate.update = !rig.gate.scan_open && pick(30) == 0;
      rig.acquisition.drains_at_once = pick(2) == 0;
      return;
    case 8:
      rig.temperatures.tip_cc = static_cast<std::int16_t>(pick(300) == 0 ? 4200 : 3650);
      return;
    default:
      rig.tick(static_cast<std::int64_t>(pick(40) == 0 ? 3000 : 20));
      return;
  }
}

struct Walk {
  int violations = 0;
  int lit_steps = 0;
  int scans = 0;
  std::size_t transitions = 0;
  std::size_t notices_of_states = 0;
};

Walk walk(std::uint64_t seed, int steps, const std::function<bool(ProbeState)>& allowed) {
  std::mt19937_64 random(seed);
  ControlRig rig;
  rig.boot();
  Walk result;
  ProbeState before = rig.state();
  rig.notices.clear();
  for (int i = 0; i < steps; ++i) {
    random_action(rig, random);
    if (rig.lamp.enabled()) {
      ++result.lit_steps;
      if (!allowed(rig.state())) ++result.violations;
    }
    if (rig.state() != before) ++result.transitions;
    before = rig.state();
  }
  for (const Notice& n : rig.notices) result.notices_of_states += n.code <= 10 ? 1U : 0U;
  result.scans = rig.acquisition.scans;
  return result;
}

bool allowed(ProbeState s) {
  return s == ProbeState::kScanning || s == ProbeState::kSelftest || s == ProbeState::kWarmup;
}

TEST(LightProperty, the_light_is_on_only_in_scanning_selftest_and_warmup) {
  int lit = 0;
  int scans = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    const Walk w = walk(seed, 5'000, allowed);
    EXPECT_EQ(w.violations, 0) << "seed " << seed;
    EXPECT_GE(w.notices_of_states, w.transitions) << "a transition without an event, seed " << seed;
    lit += w.lit_steps;
    scans += w.scans;
  }
  EXPECT_GT(lit, 5'000);  // the walk goes where light is
  EXPECT_GT(scans, 200);
}

/// Negative control: the same walk against a stricter rule must find violations.
TEST(LightProperty, the_check_finds_light_where_a_rule_forbids_it) {
  int violations = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    violations += walk(seed, 5'000, [](ProbeState s) { return s == ProbeState::kScanning; }).violations;
  }
  EXPECT_GT(violations, 10);
}

TEST(ProbeFsm, every_state_can_be_made_safe_and_nothing_leaves_safe_by_itself) {
  for (const ProbeState s :
       {ProbeState::kBoot, ProbeState::kSelftest, ProbeState::kIdle, ProbeState::kWarmup, ProbeState::kReady,
        ProbeState::kScanning, ProbeState::kPaused, ProbeState::kFault, ProbeState::kUpdating}) {
    EXPECT_EQ(next_state(s, Input::kSafeOff), ProbeState::kSafe);
    EXPECT_EQ(next_state(s, Input::kInterlock), ProbeState::kSafe);
  }
  for (int i = 0; i < kInputs; ++i) {
    const auto next = next_state(ProbeState::kSafe, static_cast<Input>(i));
    EXPECT_EQ(next.has_value(), static_cast<Input>(i) == Input::kCmdSelfTest);
  }
}

TEST(ProbeFsm, the_table_has_one_row_for_a_state_and_input) {
  const auto table = transitions();
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t j = i + 1; j < table.size(); ++j) {
      EXPECT_FALSE(table[i].from == table[j].from && table[i].input == table[j].input)
          << name_of(table[i].from) << " / " << name_of(table[i].input);
    }
  }
}

TEST(ProbeFsm, scanning_starts_only_from_ready_and_paused) {
  for (const Transition& t : transitions()) {
    if (t.to == ProbeState::kScanning) {
      EXPECT_TRUE(t.from == ProbeState::kReady || t.from == ProbeState::kPaused);
      EXPECT_EQ(t.input, Input::kCmdStart);
    }
  }
}

}  // namespace
}  // namespace enamel::fw::test
