// Eight bursts of which one meets a fault.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <utility>

#include "firmware/acquire/assembler.hpp"
#include "tests/unit/firmware/device_run.hpp"

namespace enamel::fw::test {

inline constexpr std::uint64_t kVictim = 3;
inline constexpr std::uint64_t kBursts = 8;

/// Plays eight bursts; `harm` changes the steps of burst 3, or of the sentinel before it.
class AssemblerFault : public testing::Test {
 protected:
  void harm_at(int position, std::function<void(SimStep&)> harm) {
    SimFaults faults;
    faults.on_step = [position, harm = std::move(harm)](SimStep& s) {
      if (s.position == position && s.burst_index == kVictim) harm(s);
    };
    run.device().set_faults(std::move(faults));
  }
  /// Only the victim is lost, for this reason; every other burst is whole and holds its own frames.
  void expect_lost_for(proto::DropReason reason) {
    run.run();
    ASSERT_EQ(run.given_up.size(), 1U);
    EXPECT_EQ(run.given_up[0].burst_index, kVictim);
    EXPECT_EQ(run.given_up[0].reason, reason) << name_of(run.given_up[0].reason);
    expect_others_whole();
  }
  void expect_others_whole() {
    EXPECT_EQ(run.bursts.size() + run.given_up.size(), kBursts);
    EXPECT_EQ(run.assembler().begun(), kBursts);
    EXPECT_EQ(run.assembler().under_way(), 0U);
    for (const AssembledBurst& b : run.bursts) {
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(tag_of(b.frames[k].frame.pixels.bytes()), std::pair(b.burst_index, static_cast<int>(k)));
      }
    }
  }
  static void erase_edges(SimStep& s, EdgeKind kind) {
    std::erase_if(s.edges, [&](const Edge& e) { return e.kind == kind; });
  }

  DeviceRun run{TaggedSource::Config{.count = kBursts}};
};

}  // namespace enamel::fw::test
