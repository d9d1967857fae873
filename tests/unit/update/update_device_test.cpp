// The device half of an update: refusals by number, resume, strange hosts.
#include "tests/unit/update/update_probe.hpp"

namespace enamel::fw {
namespace {

TEST_F(Update, newer_image_becomes_pending_and_is_confirmed_by_the_new_firmware) {
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

TEST_F(Update, each_refusal_has_its_number_and_writes_nothing) {
  const std::vector<std::byte> good = make({2, 0, 0, 0}, 2);
  const std::uint64_t before = flash_.operations();
  image::ImageDescription d = test::plain_description();
  d.version = {2, 0, 0, 0};
  EXPECT_EQ(download(make({0, 9, 0, 0}, 1)), number(Refusal::kRollback));
  EXPECT_EQ(download(test::build(d, payload_, {})), number(Refusal::kUnsigned));
  const image::Signer stranger = test::make_signer(50);
  EXPECT_EQ(download(test::build(d, payload_, {&stranger, 1})), number(Refusal::kUnknownKey));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2, 2, image::image_flags::kDevelopment)), number(Refusal::kDevSigned));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2, 0, image::image_flags::kFull | image::image_flags::kFactoryOnly)),
            number(Refusal::kFactoryOnly));
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

TEST_F(Update, revoked_key_is_refused_by_the_updater_but_still_boots) {
  ControlBlock block = control();
  block.revoked = 1;
  ASSERT_TRUE(ControlStore(boot_regions(flash_).control).store(block));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), number(Refusal::kKeyRevoked));
  auto workspace = std::make_unique<SlotWorkspace>();
  EXPECT_TRUE(check_slot(boot_regions(flash_).slot[0], test::test_hardware(), keys_.trust(), *workspace).has_value());
}

TEST_F(Update, damaged_chunk_is_refused_before_it_is_written) {
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

TEST_F(Update, older_version_needs_asking_and_is_forgotten_afterwards) {
  const std::vector<std::byte> older = make({0, 9, 0, 0}, 1);
  EXPECT_TRUE(vendor(VendorRequest::kAllowOlder));
  EXPECT_EQ(download(older), 0U);
  EXPECT_EQ(download(older), number(Refusal::kRollback));
}

TEST_F(Update, more_bytes_than_the_image_has_are_refused) {
  std::vector<std::byte> longer = make({2, 0, 0, 0}, 2);
  longer.push_back(std::byte{0});
  EXPECT_EQ(download(longer), number(Refusal::kTruncated));
}

TEST_F(Update, the_last_error_outlives_clearing_and_ends_with_the_next_attempt) {
  EXPECT_EQ(download(make({0, 9, 0, 0}, 1)), number(Refusal::kRollback)) << "read after CLRSTATUS";
  EXPECT_EQ(device_->status().last_error, number(Refusal::kRollback)) << "so that dfu-util -U can still read it";
  const std::vector<std::byte> good = make({2, 0, 0, 0}, 2);
  EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(good).first(4096)).stall);
  EXPECT_EQ(device_->status().last_error, 0U);
  EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  EXPECT_FALSE(device_->control({0x21, 6, 0, 0, 0}, {}).stall);
  services_.healthy = false;
  EXPECT_FALSE(vendor(VendorRequest::kSelfTest));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kSelfTest));
  services_.healthy = true;
  EXPECT_TRUE(vendor(VendorRequest::kSelfTest));
  EXPECT_EQ(device_->status().last_error, 0U);
}

TEST_F(Update, scans_wait_from_the_first_block_until_the_image_is_taken_back_or_refused) {
  const std::vector<std::byte> good = make({2, 0, 0, 0}, 2);
  const auto first_block = [&] {
    EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(good).first(4096)).stall);
    EXPECT_TRUE(services_.holds_scans);
    EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  };
  first_block();
  EXPECT_FALSE(device_->control({0x21, 6, 0, 0, 0}, {}).stall);
  EXPECT_FALSE(services_.holds_scans) << "taken back";
  first_block();
  EXPECT_TRUE(device_->control({0xA1, 2, 0, 0, 6}, {}).stall);
  EXPECT_FALSE(services_.holds_scans) << "an unexpected request ended it";
  clear();
  first_block();
  device_->bus_reset();
  EXPECT_FALSE(services_.holds_scans) << "the cable was pulled";
  EXPECT_EQ(download(make({0, 9, 0, 0}, 1)), number(Refusal::kRollback));
  EXPECT_FALSE(services_.holds_scans) << "refused";
  EXPECT_EQ(download(good), 0U);
  EXPECT_TRUE(services_.holds_scans) << "until the restart";
}

TEST_F(Update, abort_returns_to_idle_and_the_old_firmware_boots) {
  const std::vector<std::byte> image = make({2, 0, 0, 0}, 2);
  EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(4096)).stall);
  EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  EXPECT_FALSE(device_->control({0x21, 6, 0, 0, 0}, {}).stall);
  EXPECT_EQ(get_status().state, DfuState::kIdle);
  EXPECT_EQ(control().slot[0].state, SlotState::kConfirmed);
  EXPECT_EQ(download(image), 0U);
}

TEST_F(Update, short_reads_and_strange_blocks_are_survived) {
  const std::vector<std::byte> image = make({2, 0, 0, 0}, 2);
  EXPECT_TRUE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(100)).stall);
  EXPECT_EQ(device_->position().state, DfuState::kIdle) << "a failed read changes nothing; the host repeats";
  EXPECT_FALSE(device_->control({0x21, 1, 0, 0, 4096}, std::span(image).first(4096)).stall);
  EXPECT_EQ(get_status().state, DfuState::kDownloadIdle);
  EXPECT_FALSE(device_->control({0x21, 1, 5, 0, 4096}, std::span(image).subspan(4096, 4096)).stall);
  EXPECT_EQ(get_status(), (DfuPosition{DfuState::kError, DfuStatus::kErrAddress}));
}

TEST_F(Update, replies_are_no_longer_than_asked_for) {
  EXPECT_EQ(device_->control({0xA1, 3, 0, 0, 2}, {}).data.size(), 2U);
  EXPECT_EQ(device_->control({0xA1, 5, 0, 0, 0}, {}).data.size(), 0U);
  EXPECT_EQ(device_->control({0xC1, 0x10, 0, 0, 7}, {}).data.size(), 7U);
}

TEST_F(Update, status_is_the_same_by_upload_and_by_vendor_request) {
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

}  // namespace
}  // namespace enamel::fw
