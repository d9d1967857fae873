// Vendor requests, boots in between, recovery: what they may change and what stays as it is.
#include "firmware/update/usb_identity.hpp"
#include "tests/unit/update/update_probe.hpp"

namespace enamel::fw {
namespace {

TEST_F(Update, rollback_goes_to_a_confirmed_slot_only) {
  EXPECT_FALSE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kNotConfirmed));
  ControlBlock both = control();
  both.slot[1] = both.slot[0];
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(both));
  EXPECT_TRUE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(control().active, 1);
}

TEST_F(Update, factory_reset_needs_the_serial_and_spares_the_rest) {
  const std::vector<std::byte> before = calibration();
  ASSERT_EQ(flash_.program(flash_map::kConfig, test::random_payload(100, 1)), FlashStatus::kOk);
  image::Serial other = kSerial;
  other[0] = 'X';
  EXPECT_FALSE(vendor(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(other))));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kSerial));
  const ControlBlock block = control();
  EXPECT_TRUE(vendor(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(kSerial))));
  std::vector<std::byte> config(kEraseBlock);
  ASSERT_EQ(flash_.read(flash_map::kConfig, config), FlashStatus::kOk);
  EXPECT_TRUE(std::all_of(config.begin(), config.end(), [](std::byte b) { return b == std::byte{0xFF}; }));
  EXPECT_EQ(control(), block);
  EXPECT_EQ(calibration(), before);
}

TEST_F(Update, calibration_is_the_same_after_flashing_rollback_and_factory_reset) {
  const std::vector<std::byte> before = calibration();
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  EXPECT_EQ(boot(), 1U);
  EXPECT_TRUE(device_->confirm_running(true));
  EXPECT_EQ(calibration(), before);
  EXPECT_TRUE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(boot(), 0U);
  EXPECT_EQ(calibration(), before);
  EXPECT_TRUE(vendor(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(kSerial))));
  EXPECT_EQ(calibration(), before);
  ASSERT_EQ(flash_.erase(flash_map::kCalibration), FlashStatus::kOk);
  EXPECT_NE(calibration(), before) << "the comparison would have seen it";
  FlashRegion last = boot_regions(flash_).config;
  EXPECT_EQ(last.erase(kEraseBlock), FlashStatus::kOutside) << "the updater's view ends before the calibration";
}

TEST_F(Update, a_trial_that_was_rolled_back_neither_confirms_nor_overwrites_the_other) {
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  EXPECT_EQ(boot(), 1U);
  EXPECT_TRUE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(control().slot[1].state, SlotState::kBad);
  EXPECT_EQ(download(make({3, 0, 0, 0}, 3)), number(Refusal::kNotConfirmed)) << "slot A alone boots now";
  EXPECT_FALSE(device_->confirm_running(false));
  EXPECT_FALSE(vendor(VendorRequest::kConfirm));
  EXPECT_EQ(boot(), 0U);
}

TEST_F(Update, a_confirmation_survives_the_loss_of_either_copy) {
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  for (int cycle = 0; cycle < kTrialBoots; ++cycle) EXPECT_EQ(boot(), 1U);
  EXPECT_TRUE(device_->confirm_running(false));
  const FlashModel confirmed = flash_;
  for (const std::uint64_t copy : {std::uint64_t{0}, std::uint64_t{kEraseBlock}}) {
    flash_ = confirmed;
    ASSERT_EQ(flash_.erase(flash_map::kControl + copy), FlashStatus::kOk);
    EXPECT_EQ(control().slot[1].state, SlotState::kConfirmed);
    EXPECT_EQ(boot(), 1U);
  }
}

TEST_F(Update, an_update_cut_short_after_the_boot_block_was_lost_boots_the_old_firmware) {
  for (const std::uint64_t copy : {std::uint64_t{0}, std::uint64_t{kEraseBlock}}) {
    ASSERT_EQ(flash_.erase(flash_map::kControl + copy), FlashStatus::kOk);
  }
  EXPECT_EQ(boot(), 0U);
  flash_.cut_at(flash_.operations() + 4, 0, 1);
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), number(Refusal::kFlashWrite));
  flash_.restore_power();
  EXPECT_EQ(control().slot[1].state, SlotState::kWriting);
  EXPECT_EQ(boot(), 0U);
  EXPECT_TRUE(device_->confirm_running(false));
  EXPECT_EQ(control().slot[0].state, SlotState::kConfirmed);
}

TEST_F(Update, recovery_takes_an_image_whatever_the_tries_are) {
  ControlBlock spent = control();
  spent.slot[1] = spent.slot[0];
  for (SlotRecord& slot : spent.slot) slot.state = SlotState::kTrial;
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(spent));
  EXPECT_EQ(boot(), std::nullopt) << "no tries left anywhere";
  EXPECT_EQ(device_->position().state, DfuState::kAppIdle);
  EXPECT_FALSE(vendor(VendorRequest::kConfirm));
  EXPECT_FALSE(vendor(VendorRequest::kRollback));
  EXPECT_FALSE(device_->control({0x21, 0, 700, 0, 0}, {}).stall);
  EXPECT_EQ(device_->detach_timeout_ms(), 700);
  device_->detach_timed_out();
  EXPECT_EQ(device_->position().state, DfuState::kAppIdle);
  EXPECT_FALSE(device_->control({0x21, 0, 700, 0, 0}, {}).stall);
  device_->bus_reset();
  EXPECT_EQ(device_->position().state, DfuState::kIdle);
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  EXPECT_EQ(boot(), 1U);
}

TEST(UsbIdentity, tells_run_mode_from_recovery) {
  UpdateIdentity identity;
  EXPECT_EQ(usb_identity(identity).product, 0x0002);
  EXPECT_EQ(usb_identity(identity).bcd_device, 0);
  identity.running_version = image::ImageVersion{2, 7, 1, 0};
  EXPECT_EQ(usb_identity(identity).vendor, 0x1209);
  EXPECT_EQ(usb_identity(identity).product, 0x0001);
  EXPECT_EQ(usb_identity(identity).bcd_device, 0x0207);
  const std::array<std::uint8_t, 9> wanted = {9, 0x21, 0x07, 0xE8, 0x03, 0x00, 0x10, 0x10, 0x01};
  EXPECT_EQ(dfu_functional_descriptor({}), wanted);
}

TEST_F(Update, the_calibration_is_read_in_blocks_and_never_written) {
  const auto block = [&](std::uint16_t i, std::uint16_t length = 4096) {
    return device_->control({0xC1, 0x11, i, 0, length}, {});
  };
  EXPECT_TRUE(std::ranges::equal(block(1).data, std::span(services_.rig).subspan(4096, 4096)));
  EXPECT_EQ(block(2).data.size(), services_.rig.size() - 2 * 4096);
  EXPECT_EQ(block(3).data.size(), 0U);
  EXPECT_EQ(block(0, 100).data.size(), 100U);
  EXPECT_TRUE(device_->control({0x41, 0x11, 0, 0, 0}, {}).stall) << "there is no way in";
  services_.rig.clear();
  EXPECT_TRUE(block(0).stall);
  EXPECT_EQ(device_->status().last_error, number(Refusal::kNoCalibration));
}

TEST_F(Update, self_test_and_reboot) {
  EXPECT_TRUE(vendor(VendorRequest::kSelfTest));
  services_.healthy = false;
  EXPECT_FALSE(vendor(VendorRequest::kSelfTest));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kSelfTest));
  EXPECT_TRUE(vendor(VendorRequest::kReboot, 1));
  EXPECT_EQ(services_.rebooted, 2);
  EXPECT_FALSE(vendor(static_cast<VendorRequest>(0x77)));
}

}  // namespace
}  // namespace enamel::fw
