// The device half of an update, spoken to as a USB host would: refusals by number, resume, vendor requests.
#include "firmware/update/update_device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/transitions.hpp"
#include "firmware/sim/flash_model.hpp"
#include "protocol/image/dfu_suffix.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::fw {
namespace {

using image::Refusal;
using image::VendorRequest;
using test::KeyRing;

class Services final : public UpdateServices {
 public:
  bool scanning() const noexcept override { return is_scanning; }
  std::uint16_t battery_mv() const noexcept override { return 3900; }
  bool power_suffices() const noexcept override { return has_power; }
  bool self_test() noexcept override { return healthy; }
  void reboot(bool recovery) noexcept override { rebooted = recovery ? 2 : 1; }
  bool is_scanning = false, has_power = true, healthy = true;
  int rebooted = 0;
};

constexpr image::Serial kSerial = {'E', 'N', '2', '-', '0', '0', '7'};

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
    device_->work();
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

  KeyRing keys_;
  Services services_;
  std::vector<std::byte> payload_ = test::random_payload(3 * image::kChunkSize + 5, 21);
  FlashModel flash_;
  std::unique_ptr<UpdateDevice> device_;
};

constexpr std::uint32_t number(Refusal why) { return static_cast<std::uint32_t>(why); }

TEST_F(Update, NewerImageBecomesPendingAndIsConfirmedByTheNewFirmware) {
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  EXPECT_EQ(control().slot[1].state, SlotState::kPending);
  EXPECT_EQ(control().slot[0].state, SlotState::kConfirmed);
  ControlBlock trial = control();
  trial.slot[1].state = SlotState::kTrial;
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(trial));
  start(1);
  EXPECT_EQ(download(make({3, 0, 0, 0}, 3)), number(Refusal::kNotConfirmed))
      << "a trial may not overwrite the fallback";
  EXPECT_TRUE(device_->confirm_running(false));
  EXPECT_EQ(control().active, 1);
  EXPECT_EQ(control().min_security_counter, 0U);
  EXPECT_TRUE(device_->raise_counter_now());
  EXPECT_EQ(control().min_security_counter, 1U) << "not above the counter of the confirmed fallback";
  EXPECT_TRUE(vendor(VendorRequest::kConfirm, 1));
  EXPECT_EQ(control().min_security_counter, 2U);
}

TEST_F(Update, EachRefusalHasItsNumberAndWritesNothing) {
  const std::vector<std::byte> good = make({2, 0, 0, 0}, 2);
  const std::uint64_t before = flash_.operations();
  image::ImageDescription d = test::plain_description();
  d.version = {2, 0, 0, 0};
  EXPECT_EQ(download(make({0, 9, 0, 0}, 1)), number(Refusal::kRollback));
  EXPECT_EQ(download(test::build(d, payload_, {})), number(Refusal::kUnsigned));
  const image::Signer stranger = test::make_signer(50);
  EXPECT_EQ(download(test::build(d, payload_, {&stranger, 1})), number(Refusal::kUnknownKey));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2, 2, image::image_flags::kDevelopment)), number(Refusal::kDevSigned));
  d.hw_rev_max = 1;
  EXPECT_EQ(download(test::build(d, payload_, {&keys_.signer(0), 1})), number(Refusal::kHardware));
  EXPECT_EQ(download(test::random_payload(9000, 1)), number(Refusal::kMagic));
  EXPECT_EQ(download(std::span(good).first(4000)), number(Refusal::kTruncated));
  std::vector<std::byte> dfuse = test::random_payload(5000, 1);
  const std::string_view prefix = "DfuSe";
  std::copy(prefix.begin(), prefix.end(), reinterpret_cast<char*>(dfuse.data()));
  EXPECT_EQ(download(dfuse), number(Refusal::kDfuSe));
  services_.is_scanning = true;
  EXPECT_EQ(download(good), number(Refusal::kBusyScanning));
  services_.is_scanning = false;
  services_.has_power = false;
  EXPECT_EQ(download(good), number(Refusal::kBattery));
  services_.has_power = true;
  EXPECT_EQ(flash_.operations(), before) << "nothing may be written before the manifest is proven";
  EXPECT_EQ(download(good), 0U);
}

TEST_F(Update, RevokedKeyIsRefusedByTheUpdaterButStillBoots) {
  ControlBlock block = control();
  block.revoked = 1;
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(block));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), number(Refusal::kKeyRevoked));
  auto workspace = std::make_unique<SlotWorkspace>();
  EXPECT_TRUE(check_slot(boot_regions(flash_).slot[0], test::test_hardware(), keys_.trust(), *workspace).has_value());
}

TEST_F(Update, DamagedChunkIsRefusedBeforeItIsWritten) {
  const std::vector<std::byte> good = make({2, 0, 0, 0}, 2);
  std::vector<std::byte> damaged = good;
  damaged[damaged.size() - payload_.size() + image::kChunkSize + 9] ^= std::byte{4};
  EXPECT_EQ(download(damaged), number(Refusal::kChunkHash));
  EXPECT_EQ(device_->status().chunks_done, 1U);
  // Boot block, one sector; what the first chunk and the manifest took is not written again.
  const std::uint64_t resumed = writes_of(good);
  EXPECT_EQ(control().slot[1].state, SlotState::kPending);
  EXPECT_LT(resumed, 3 * 129U);
}

TEST_F(Update, OlderVersionNeedsAskingAndIsForgottenAfterwards) {
  const std::vector<std::byte> older = make({0, 9, 0, 0}, 1);
  EXPECT_TRUE(vendor(VendorRequest::kAllowOlder));
  EXPECT_EQ(download(older), 0U);
  EXPECT_EQ(download(older), number(Refusal::kRollback));
}

TEST_F(Update, MoreBytesThanTheImageHasAreRefused) {
  std::vector<std::byte> longer = make({2, 0, 0, 0}, 2);
  longer.push_back(std::byte{0});
  EXPECT_EQ(download(longer), number(Refusal::kTruncated));
}

TEST_F(Update, AbortReturnsToIdleAndTheOldFirmwareBoots) {
  const std::vector<std::byte> image = make({2, 0, 0, 0}, 2);
  EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(4096)).stall);
  EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  EXPECT_FALSE(device_->control({0x21, 6, 0, 0, 0}, {}).stall);
  EXPECT_EQ(get_status().state, DfuState::kIdle);
  EXPECT_EQ(control().slot[0].state, SlotState::kConfirmed);
  EXPECT_EQ(download(image), 0U);
}

TEST_F(Update, ShortReadsAndStrangeBlocksAreSurvived) {
  const std::vector<std::byte> image = make({2, 0, 0, 0}, 2);
  EXPECT_TRUE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(100)).stall);
  EXPECT_EQ(device_->position().state, DfuState::kIdle) << "a failed read changes nothing; the host repeats";
  EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(4096)).stall);
  EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  EXPECT_FALSE(device_->control({0x21, 1, 5, 0, 4096}, std::span(image).subspan(4096, 4096)).stall);
  EXPECT_EQ(get_status(), (DfuPosition{DfuState::kError, DfuStatus::kErrAddress}));
}

TEST_F(Update, StatusIsTheSameByUploadAndByVendorRequest) {
  const ControlReply whole = device_->control({0xC1, 0x10, 0, 0, 4096}, {});
  const auto by_vendor = image::decode_status(whole.data);
  ASSERT_TRUE(by_vendor.has_value());
  EXPECT_EQ(by_vendor->version[0], (image::ImageVersion{1, 0, 0, 0}));
  EXPECT_EQ(by_vendor->serial, kSerial);
  // In pieces: full blocks, then a short one.
  std::vector<std::byte> pieces;
  for (std::uint16_t block = 0; block < 4; ++block) {
    const ControlReply part = device_->control({0xA1, 2, block, 0, 40}, {});
    pieces.insert(pieces.end(), part.data.begin(), part.data.end());
    if (part.data.size() < 40) break;
  }
  EXPECT_EQ(image::decode_status(pieces), by_vendor);
  EXPECT_EQ(device_->position().state, DfuState::kIdle);
}

TEST_F(Update, RollbackGoesToAConfirmedSlotOnly) {
  EXPECT_FALSE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kNotConfirmed));
  ControlBlock both = control();
  both.slot[1] = both.slot[0];
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(both));
  EXPECT_TRUE(vendor(VendorRequest::kRollback));
  EXPECT_EQ(control().active, 1);
}

TEST_F(Update, FactoryResetNeedsTheSerialAndSparesTheRest) {
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

TEST_F(Update, CalibrationIsTheSameAfterEverything) {
  const std::vector<std::byte> before = calibration();
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U);
  EXPECT_TRUE(vendor(VendorRequest::kFactoryReset, 0, std::as_bytes(std::span(kSerial))));
  EXPECT_EQ(calibration(), before);
  FlashRegion last = boot_regions(flash_).config;
  EXPECT_EQ(last.erase(kEraseBlock), FlashStatus::kOutside) << "the updater's view ends before the calibration";
}

TEST_F(Update, SelfTestAndReboot) {
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
