// Reading a slot back before it becomes bootable: in pieces, with requests in between.
#include "tests/unit/update/update_probe.hpp"

namespace enamel::fw {
namespace {

/// Counts what is read.
class CountingFlash final : public Flash {
 public:
  explicit CountingFlash(Flash& under) : under_(&under) {}
  [[nodiscard]] std::uint64_t size() const noexcept override { return under_->size(); }
  [[nodiscard]] FlashStatus read(std::uint64_t offset, std::span<std::byte> out) const noexcept override {
    bytes_read += out.size();
    return under_->read(offset, out);
  }
  [[nodiscard]] FlashStatus erase(std::uint64_t offset) noexcept override { return under_->erase(offset); }
  [[nodiscard]] FlashStatus program(std::uint64_t offset, std::span<const std::byte> bytes) noexcept override {
    return under_->program(offset, bytes);
  }
  mutable std::uint64_t bytes_read = 0;

 private:
  Flash* under_;
};

class ReadBack : public Update {
 protected:
  /// Everything has been sent, and the host has been told dfuMANIFEST.
  void send_all() {
    device_ = std::make_unique<UpdateDevice>(
        boot_regions(counted_),
        UpdateIdentity{test::test_hardware(), keys_.trust(), 0, image::ImageVersion{1, 0, 0, 0}}, kSerial, services_);
    const std::vector<std::byte> image = make({2, 0, 0, 0}, 2);
    std::uint16_t block = 0;
    for (std::size_t at = 0; at < image.size(); at += 4096) {
      const auto n = static_cast<std::uint16_t>(std::min<std::size_t>(4096, image.size() - at));
      ASSERT_FALSE(device_->control({0x21, 1, block++, 0, n}, std::span(image).subspan(at, n)).stall);
      ASSERT_EQ(get_status().state, DfuState::kDownloadIdle);
    }
    ASSERT_FALSE(device_->control({0x21, 1, block, 0, 0}, {}).stall);
    EXPECT_FALSE(device_->work_pending()) << "the host has not asked yet";
    ASSERT_EQ(status_only().state, DfuState::kManifest);
  }
  /// GETSTATUS without the work that it may leave behind.
  DfuPosition status_only() {
    const ControlReply reply = device_->control({0xA1, 3, 0, 0, 6}, {});
    EXPECT_EQ(reply.data.size(), 6U);
    return {static_cast<DfuState>(reply.data[4]), static_cast<DfuStatus>(reply.data[0])};
  }

  CountingFlash counted_{flash_};
};

TEST_F(ReadBack, a_piece_is_bounded_and_requests_are_answered_in_between) {
  send_all();
  std::size_t pieces = 0;
  while (device_->work_pending()) {
    EXPECT_EQ(status_only().state, DfuState::kManifest);
    EXPECT_EQ(device_->control({0xC1, 0x10, 0, 0, 4096}, {}).data.size(), image::kStatusSize);
    EXPECT_EQ(control().slot[1].state, SlotState::kWriting) << "not bootable before all of it was read";
    const std::uint64_t before = counted_.bytes_read;
    device_->work();
    EXPECT_LE(counted_.bytes_read - before, image::kChunkSize);
    ++pieces;
  }
  EXPECT_EQ(pieces, 6U) << "manifest, four chunks, the boot block";
  EXPECT_EQ(status_only().state, DfuState::kIdle);
  EXPECT_EQ(control().slot[1].state, SlotState::kPending);
}

TEST_F(ReadBack, a_chunk_that_the_flash_lost_is_seen) {
  send_all();
  device_->work();
  ASSERT_EQ(flash_.erase(flash_map::kSlot + flash_map::kSlotSize + 3 * kEraseBlock), FlashStatus::kOk);
  while (device_->work_pending()) device_->work();
  EXPECT_EQ(status_only(), (DfuPosition{DfuState::kError, DfuStatus::kErrNotDone}));
  EXPECT_EQ(device_->status().last_error, number(Refusal::kIncomplete));
  EXPECT_EQ(control().slot[1].state, SlotState::kWriting);
  EXPECT_EQ(clear(), number(Refusal::kIncomplete));
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U) << "the lost chunk is written again";
}

TEST_F(ReadBack, a_reset_in_the_middle_leaves_the_slot_unbootable) {
  send_all();
  device_->work();
  device_->work();
  device_->bus_reset();
  EXPECT_FALSE(device_->work_pending());
  device_->work();
  EXPECT_EQ(control().slot[1].state, SlotState::kWriting);
  EXPECT_EQ(download(make({2, 0, 0, 0}, 2)), 0U) << "from the first chunk on";
}

}  // namespace
}  // namespace enamel::fw
