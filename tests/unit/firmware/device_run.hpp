// Runs a simulated device into an assembler step by step, as the acquisition thread does, in virtual time.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "firmware/acquire/assembler.hpp"
#include "firmware/acquire/sequencer.hpp"
#include "firmware/device/sim/sim_device.hpp"
#include "tests/unit/firmware/tagged_source.hpp"
#include "tests/unit/firmware/virtual_clock.hpp"

namespace enamel::fw::test {

class DeviceRun {
 public:
  explicit DeviceRun(TaggedSource::Config source = {}, SimConfig sim = virtual_time()) {
    auto made = SimDevice::create(std::make_unique<TaggedSource>(std::move(source)), clock_, sim);
    if (!made) {
      ADD_FAILURE() << made.error().message();
      return;
    }
    device_ = std::move(*made);
    device_->set_enabled(true);
    assembler_ = std::make_unique<BurstAssembler>(AssemblerConfig::for_mode(device_->mode(), sim.stamp_delay));
    EXPECT_TRUE(device_->start().has_value());
    sequencer_.start();
  }
  static SimConfig virtual_time() {
    SimConfig sim;
    sim.read_ahead = 0;
    return sim;
  }

  /// One frame. False at the end of the source.
  bool step() {
    if (sequencer_.want_arm()) {
      const bool armed = device_->arm().has_value();
      if (!armed && assembler_->under_way() == 0) return false;
      if (armed) sequencer_.on_armed();
    }
    auto frame = device_->next_frame();
    std::vector<Edge> edges;
    const DeviceTime known_until = device_->read(edges);
    for (const Edge& e : edges) {
      assembler_->push_edge(e);
      if (e.kind == EdgeKind::kGate) sequencer_.on_begun(1);
    }
    if (frame) {
      sequencer_.on_frame(frame->status == FrameStatus::kSuccess);
      assembler_->push_frame(std::move(*frame));
    }
    assembler_->edges_known_until(known_until);
    if (!frame) assembler_->abort(proto::DropReason::kOther);
    for (BurstOutcome& o : assembler_->take_outcomes()) {
      if (auto* whole = std::get_if<AssembledBurst>(&o)) {
        bursts.push_back(std::move(*whole));
      } else {
        given_up.push_back(std::get<GivenUpBurst>(o));
        (void)device_->restart();
      }
    }
    return frame.has_value();
  }
  void run() {
    while (step()) {
    }
  }
  void pause(Nanoseconds how_long) {
    device_->stop();
    assembler_->abort(proto::DropReason::kOther);
    clock_.sleep_for(how_long);
    EXPECT_TRUE(device_->start().has_value());
    sequencer_.start();
  }
  [[nodiscard]] SimDevice& device() { return *device_; }
  [[nodiscard]] BurstAssembler& assembler() { return *assembler_; }
  [[nodiscard]] VirtualClock& clock() { return clock_; }

  std::vector<AssembledBurst> bursts;
  std::vector<GivenUpBurst> given_up;

 private:
  VirtualClock clock_;
  std::unique_ptr<SimDevice> device_;
  std::unique_ptr<BurstAssembler> assembler_;
  Sequencer sequencer_;
};

}  // namespace enamel::fw::test
