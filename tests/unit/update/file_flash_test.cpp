// Flash on a file: what a program finds again after it was ended, and what it refuses to open.
#include "firmware/storage/file_flash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <vector>

#include "firmware/boot/control_block.hpp"
#include "tests/support/run.hpp"

namespace enamel::fw {
namespace {

using test::TempFolder;

class FileFlashTest : public testing::Test {
 protected:
  FileFlashTest() { resize(flash_map::kSize); }
  void resize(std::uint64_t size) {
    static_cast<void>(write_file(path_, ""));
    std::filesystem::resize_file(path_, size);
  }
  [[nodiscard]] std::unique_ptr<FileFlash> open() const { return FileFlash::open(path_, flash_map::kSize).value(); }

  TempFolder folder_;
  std::string path_ = folder_ / "flash";
};

TEST_F(FileFlashTest, keeps_what_was_written_beside) {
  const std::vector<std::byte> bytes(5000, std::byte{0x5A});
  {
    const auto flash = open();
    ASSERT_EQ(flash->erase(kEraseBlock), FlashStatus::kOk);
    ASSERT_EQ(flash->program(kEraseBlock + 100, bytes), FlashStatus::kOk);
  }
  std::vector<std::byte> back(kEraseBlock);
  ASSERT_EQ(open()->read(kEraseBlock, back), FlashStatus::kOk);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), back.begin() + 100));
  EXPECT_EQ(back[99], std::byte{0xFF}) << "erased";
  EXPECT_EQ(back[5100], std::byte{0xFF});
  ASSERT_EQ(open()->read(2 * kEraseBlock, back), FlashStatus::kOk);
  EXPECT_EQ(back[0], std::byte{0}) << "the block behind was not erased";
}

TEST_F(FileFlashTest, a_boot_block_outlives_the_program) {
  ControlBlock block;
  block.min_security_counter = 7;
  {
    const auto flash = open();
    ASSERT_TRUE(ControlStore(boot_regions(*flash).control).store(block));
  }
  const auto flash = open();
  const auto loaded = ControlStore(boot_regions(*flash).control).load();
  ASSERT_TRUE(loaded.has_value());
  EXPECT_EQ(loaded->min_security_counter, 7U);
}

TEST_F(FileFlashTest, has_edges) {
  const auto flash = open();
  std::array<std::byte, 2> two{};
  EXPECT_EQ(flash->size(), flash_map::kSize);
  EXPECT_EQ(flash->erase(1), FlashStatus::kUnaligned);
  EXPECT_EQ(flash->erase(flash_map::kSize), FlashStatus::kOutside);
  EXPECT_EQ(flash->program(flash_map::kSize - 1, two), FlashStatus::kOutside);
  EXPECT_EQ(flash->read(flash_map::kSize - 1, two), FlashStatus::kOutside);
  EXPECT_EQ(flash->read(~0ULL, two), FlashStatus::kOutside);
}

TEST_F(FileFlashTest, refuses_what_is_no_whole_flash) {
  const auto code = [&](const std::string& path) {
    const auto flash = FileFlash::open(path, flash_map::kSize);
    return flash ? ErrorCode::kInternal : flash.error().code;
  };
  EXPECT_EQ(code(folder_ / "absent"), ErrorCode::kFileNotFound);
  EXPECT_EQ(code(folder_.path().string()), ErrorCode::kFlash);
  EXPECT_EQ(code("/dev/null"), ErrorCode::kFlash);
  {
    const auto flash = open();
    EXPECT_EQ(code(path_), ErrorCode::kFlash) << "one updater at a time";
  }
  resize(flash_map::kSize - 1);
  EXPECT_EQ(code(path_), ErrorCode::kFlash);
}

}  // namespace
}  // namespace enamel::fw
