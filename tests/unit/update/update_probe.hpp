// A probe's device half on a flash model, spoken to as a USB host would.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/transitions.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/update_device.hpp"
#include "protocol/image/dfu_suffix.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::fw {

using image::Refusal;
using image::VendorRequest;
using test::KeyRing;

class Services final : public UpdateServices {
 public:
  bool scanning() const noexcept override { return is_scanning; }
  bool hold_scans() noexcept override { return holds_scans = !is_scanning; }
  void let_scan() noexcept override { holds_scans = false; }
  std::uint16_t battery_mv() const noexcept override { return 3900; }
  bool power_suffices() const noexcept override { return has_power; }
  bool self_test() noexcept override { return healthy; }
  std::optional<std::size_t> read_calibration(std::size_t offset, std::span<std::byte> out) noexcept override {
    if (rig.empty()) return std::nullopt;
    const std::size_t from = std::min(offset, rig.size()), n = std::min(out.size(), rig.size() - from);
    std::copy_n(rig.begin() + static_cast<std::ptrdiff_t>(from), n, out.begin());
    return n;
  }
  void reboot(bool recovery) noexcept override { rebooted = recovery ? 2 : 1; }
  bool is_scanning = false, holds_scans = false, has_power = true, healthy = true;
  int rebooted = 0;
  std::vector<std::byte> rig = test::random_payload(9000, 31);
};

inline constexpr image::Serial kSerial = {'E', 'N', '2', '-', '0', '0', '7'};

class Update : public testing::Test {
 protected:
  Update() : flash_(flash_map::kSize) {
    start(1);
    EXPECT_EQ(download(make({1, 0, 0, 0}, 1)), 0U);
    ControlStore store(boot_regions(flash_).control);
    EXPECT_TRUE(store.store(confirm(*store.load(), 0)));
    write_calibration();
    start(0);
  }

  void start(std::size_t running) {
    device_ = std::make_unique<UpdateDevice>(
        boot_regions(flash_),
        UpdateIdentity{test::test_hardware(), keys_.trust(), running, image::ImageVersion{1, 0, 0, 0}}, kSerial,
        services_);
  }

  /// Bootloader, then the firmware of the slot it chose, or recovery.
  std::optional<std::size_t> boot() {
    Judge judge(*this);
    ControlStore store(boot_regions(flash_).control);
    const std::optional<std::size_t> slot = choose_slot(store, judge);
    if (slot) {
      start(*slot);
    } else {
      const std::size_t keep = slot_to_keep(store, judge);
      device_ = std::make_unique<UpdateDevice>(boot_regions(flash_),
                                               UpdateIdentity{test::test_hardware(), keys_.trust(), keep, std::nullopt},
                                               kSerial, services_, DfuConfig{.runtime = true});
    }
    return slot;
  }

  std::vector<std::byte> make(image::ImageVersion version, std::uint32_t counter, std::size_t key = 0,
                              std::uint32_t flags = image::image_flags::kFull) {
    image::ImageDescription d = test::plain_description();
    d.version = version;
    d.security_counter = counter;
    d.flags = flags;
    std::vector<std::byte> file = test::build(d, payload_, {&keys_.signer(key), 1});
    file.resize(file.size() - image::kSuffixSize);
    return file;
  }

  DfuPosition get_status() {
    const ControlReply reply = device_->control({0xA1, 3, 0, 0, 6}, {});
    EXPECT_EQ(reply.data.size(), 6U);
    const DfuPosition told{static_cast<DfuState>(reply.data[4]), static_cast<DfuStatus>(reply.data[0])};
    while (device_->work_pending()) device_->work();
    return told;
  }

  /// As a host does it. The device's last error, 0 when the image was accepted.
  std::uint32_t download(std::span<const std::byte> image) {
    std::uint16_t block = 0;
    for (std::size_t at = 0; at < image.size(); at += 4096) {
      const auto n = static_cast<std::uint16_t>(std::min<std::size_t>(4096, image.size() - at));
      EXPECT_FALSE(device_->control({0x21, 1, block++, 0, n}, image.subspan(at, n)).stall);
      if (get_status().state == DfuState::kError) return clear();
    }
    if (device_->control({0x21, 1, block, 0, 0}, {}).stall) return clear();
    EXPECT_EQ(get_status().state, DfuState::kManifest);
    const DfuPosition end = get_status();
    return end.state == DfuState::kIdle ? 0 : clear();
  }

  std::uint32_t clear() {
    EXPECT_FALSE(device_->control({0x21, 4, 0, 0, 0}, {}).stall);
    EXPECT_EQ(device_->position().state, DfuState::kIdle) << "the device stays usable";
    return device_->status().last_error;
  }

  bool vendor(VendorRequest request, std::uint16_t value = 0, std::span<const std::byte> data = {}) {
    return !device_
                ->control({0x41, static_cast<std::uint8_t>(request), value, 0, static_cast<std::uint16_t>(data.size())},
                          data)
                .stall;
  }

  void write_calibration() {
    const auto bytes = test::random_payload(2 * kEraseBlock, 11);
    EXPECT_EQ(flash_.program(flash_map::kCalibration, bytes), FlashStatus::kOk);
  }
  std::vector<std::byte> calibration() {
    std::vector<std::byte> bytes(2 * kEraseBlock);
    EXPECT_EQ(flash_.read(flash_map::kCalibration, bytes), FlashStatus::kOk);
    return bytes;
  }
  ControlBlock control() { return *ControlStore(boot_regions(flash_).control).load(); }
  std::uint64_t writes_of(std::span<const std::byte> image) {
    const std::uint64_t before = flash_.operations();
    static_cast<void>(download(image));
    return flash_.operations() - before;
  }

  class Judge final : public SlotJudge {
   public:
    explicit Judge(Update& probe) : probe_(&probe) {}
    bool verifies(std::size_t slot) noexcept override {
      return check_slot(boot_regions(probe_->flash_).slot[slot], test::test_hardware(), probe_->keys_.trust(),
                        *workspace_)
          .has_value();
    }

   private:
    Update* probe_;
    std::unique_ptr<SlotWorkspace> workspace_ = std::make_unique<SlotWorkspace>();
  };

  KeyRing keys_;
  Services services_;
  std::vector<std::byte> payload_ = test::random_payload(3 * image::kChunkSize + 5, 21);
  FlashModel flash_;
  std::unique_ptr<UpdateDevice> device_;
};

inline constexpr std::uint32_t number(Refusal why) { return static_cast<std::uint32_t>(why); }

}  // namespace enamel::fw
