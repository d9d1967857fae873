#include "tests/fuzz/fuzz_probe.hpp"

#include <algorithm>

#include "firmware/boot/transitions.hpp"
#include "tests/fuzz/demand.hpp"

namespace enamel::test {

using namespace fw;

class FuzzProbe::Judge final : public SlotJudge {
 public:
  Judge(FuzzProbe& probe, FlashModel& flash) : probe_(&probe), flash_(&flash) {}
  bool verifies(std::size_t slot) noexcept override { return probe_->verifies(*flash_, slot); }

 private:
  FuzzProbe* probe_;
  FlashModel* flash_;
};

FuzzProbe::FuzzProbe(const FlashModel& factory, const KeyRing& keys, const std::set<Sha256Digest>& trusted)
    : keys_(&keys), trusted_(&trusted), flash_(factory) {
  flash_.watch([this](const FlashModel::Operation& op) { watch(op); });
  boot(false);
}

bool FuzzProbe::verifies(FlashModel& flash, std::size_t slot) {
  const auto content = flash.versions(flash_map::kSlot + slot * flash_map::kSlotSize, flash_map::kSlotSize);
  const auto [entry, fresh] = known_.try_emplace(content, false);
  if (fresh) {
    SlotWorkspace workspace;
    entry->second = check_slot(boot_regions(flash).slot[slot], test_hardware(), keys_->trust(), workspace).has_value();
  }
  return entry->second;
}

ControlBlock FuzzProbe::block() { return ControlStore(boot_regions(flash_).control).load().value_or(ControlBlock{}); }

void FuzzProbe::watch(const FlashModel::Operation& op) {
  if (op.offset < flash_map::kSlot) return;
  if (op.offset >= flash_map::kConfig) {
    demand(resetting_ && op.offset + op.length <= flash_map::kUpdaterEnd, "only a factory reset writes settings");
    return;
  }
  const std::size_t slot = (op.offset - flash_map::kSlot) / flash_map::kSlotSize;
  demand(slot != kept_, "the slot that runs is not written");
  const SlotRecord record = block().slot[slot];
  demand(record.state == SlotState::kWriting, "a slot is marked before it is written");
  demand(trusted_->contains(record.manifest_sha), "a manifest is verified before the first erase");
}

void FuzzProbe::demand_position() const {
  const DfuPosition at = device_->position();
  demand(at.state <= DfuState::kError && at.state != DfuState::kManifestWaitReset, "a state of the table");
  demand(recovery() || at.state >= DfuState::kIdle, "run mode rests in dfuIDLE");
  demand((at.state == DfuState::kError) == (at.status != DfuStatus::kOk), "an error has a status and nothing else has");
  demand(at.state != DfuState::kError || !device_->work_pending(), "no work is left over after an error");
}

void FuzzProbe::demand_bootable() {
  if (flash_.operations() == looked_at_) return;
  looked_at_ = flash_.operations();
  FlashModel copy = flash_;
  copy.watch({});
  copy.restore_power();
  ControlStore store(boot_regions(copy).control);
  Judge judge(*this, copy);
  for (int cycle = 0; cycle < 4; ++cycle) {
    const std::optional<std::size_t> slot = choose_slot(store, judge);
    demand(slot.has_value(), "the probe boots");
    demand(verifies(copy, *slot), "what boots verifies");
  }
}

ControlReply FuzzProbe::control(const SetupPacket& setup, std::span<const std::byte> data) {
  const auto own = std::as_bytes(std::span(kSerial));
  resetting_ = setup.request_type == image::request_type::kVendorOut &&
               setup.request == static_cast<std::uint8_t>(image::VendorRequest::kFactoryReset) &&
               std::equal(data.begin(), data.end(), own.begin(), own.end());
  const ControlReply reply = device_->control(setup, data);
  demand(reply.data.size() <= setup.length, "a reply is not longer than asked for");
  demand((setup.request_type & 0x80U) != 0 || reply.data.empty(), "only an IN transfer has a reply");
  resetting_ = false;
  demand_position();
  return reply;
}

void FuzzProbe::cut(std::uint64_t after, std::size_t whole, std::uint64_t seed) {
  flash_.cut_at(flash_.operations() + after, whole, seed);
}

void FuzzProbe::lose_control(std::size_t copy, std::uint64_t seed) {
  flash_.tear({0, flash_map::kControl + copy * kEraseBlock, FlashModel::kSector, {}}, 0, seed);
}

void FuzzProbe::boot(bool into_recovery) {
  flash_.restore_power();
  ControlStore store(boot_regions(flash_).control);
  Judge judge(*this, flash_);
  running_ = choose_slot(store, judge);
  demand(running_.has_value(), "the probe boots");
  kept_ = *running_;
  UpdateIdentity identity{test_hardware(), keys_->trust(), kept_, block().slot[kept_].version};
  if (into_recovery) {
    running_.reset();
    kept_ = slot_to_keep(store, judge);
    identity.running_slot = kept_;
    identity.running_version.reset();
  }
  device_ = std::make_unique<UpdateDevice>(boot_regions(flash_), identity, kSerial, static_cast<UpdateServices&>(*this),
                                           DfuConfig{.runtime = into_recovery});
}

}  // namespace enamel::test
