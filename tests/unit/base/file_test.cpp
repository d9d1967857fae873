#include "protocol/base/file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temp_folder.hpp"

namespace enamel {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }
  test::TempFolder folder_;
};

TEST_F(File, comes_back_byte_for_byte) {
  const std::string bytes("a\0b\n\xff", 5);
  ASSERT_TRUE(write_file(at("x"), bytes));
  EXPECT_EQ(read_file(at("x")).value_or(""), bytes);
  EXPECT_FALSE(fs::exists(at("x.partial")));
}

TEST_F(File, empty_file_is_no_error) {
  ASSERT_TRUE(write_file(at("x"), ""));
  const auto back = read_file(at("x"));
  ASSERT_TRUE(back);
  EXPECT_TRUE(back->empty());
}

TEST_F(File, missing_file_and_folder_are_told) {
  EXPECT_EQ(read_file(at("none")).error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_file(folder_.path().string()).error().code, ErrorCode::kFileRead);
}

TEST_F(File, a_failed_write_leaves_the_old_file_alone) {
  ASSERT_TRUE(write_file(at("x"), "old"));
  fs::create_directory(at("x.partial"));  // the temporary file cannot be made
  const auto failed = write_file(at("x"), "new");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kFileWrite);
  EXPECT_EQ(read_file(at("x")).value_or(""), "old");
}

TEST_F(File, a_full_disk_is_an_error_not_a_surprise) {
  const auto failed = write_file("/dev/full/x", "anything");
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kFileWrite);
}

}  // namespace
}  // namespace enamel
