// The lock between acquisition and update process.
#include "firmware/storage/scan_lock.hpp"

#include <gtest/gtest.h>

#include "tests/support/run.hpp"

namespace enamel::fw {
namespace {

class ScanLockTest : public testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<ScanLock> open() const { return ScanLock::open(folder_ / "scanning").value(); }
  test::TempFolder folder_;
};

TEST_F(ScanLockTest, one_of_two_holds_it) {
  const auto probe = open(), updater = open();
  EXPECT_FALSE(probe->held_elsewhere());
  EXPECT_TRUE(probe->take());
  EXPECT_TRUE(probe->take()) << "held already";
  EXPECT_FALSE(probe->held_elsewhere());
  EXPECT_TRUE(updater->held_elsewhere());
  EXPECT_FALSE(updater->take());
  updater->release();
  EXPECT_TRUE(updater->held_elsewhere()) << "only the holder ends it";
  probe->release();
  EXPECT_FALSE(updater->held_elsewhere());
  EXPECT_TRUE(updater->take());
}

TEST_F(ScanLockTest, ends_with_its_holder) {
  const auto updater = open();
  {
    const auto probe = open();
    ASSERT_TRUE(probe->take());
    EXPECT_FALSE(updater->take());
  }
  EXPECT_TRUE(updater->take());
}

TEST_F(ScanLockTest, names_a_file_that_cannot_be_made) {
  const auto lock = ScanLock::open(folder_ / "absent/scanning");
  ASSERT_FALSE(lock.has_value());
  EXPECT_EQ(lock.error().code, ErrorCode::kFileWrite);
  EXPECT_NE(lock.error().detail.find("absent/scanning"), std::string::npos);
}

}  // namespace
}  // namespace enamel::fw
