#include "host/session/disk_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "protocol/base/file.hpp"
#include "tests/support/temp_folder.hpp"

namespace enamel::host {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20U;

class Guarded : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(write_file(recording_, "bursts")); }
  std::unique_ptr<DiskGuard> guard() {
    const DiskLimits limits{
        .warn_bytes = 100 * kMiB, .stop_bytes = 10 * kMiB, .reserve_bytes = kMiB, .period = Nanoseconds{2'000'000}};
    return std::make_unique<DiskGuard>(
        recording_, limits, [this] { ++ended_; }, [this] { return free_.load(); });
  }
  static bool becomes(const DiskGuard& guard, DiskState state) {
    for (int i = 0; i < 2000 && guard.state() != state; ++i) std::this_thread::sleep_for(milliseconds(2));
    return guard.state() == state;
  }
  test::TempFolder folder_;
  std::string recording_ = folder_ / "capture.mcap";
  std::atomic<std::uint64_t> free_{1000 * kMiB};
  std::atomic<int> ended_{0};
};

TEST_F(Guarded, a_disk_that_fills_up_is_told_early_and_ends_the_scan_once) {
  const auto disk = guard();
  EXPECT_EQ(disk->state(), DiskState::kAmple);
  free_ = 50 * kMiB;
  EXPECT_TRUE(becomes(*disk, DiskState::kLow));
  EXPECT_EQ(ended_, 0) << "warned, not ended";
  free_ = 500 * kMiB;
  EXPECT_TRUE(becomes(*disk, DiskState::kAmple)) << "somebody made room";
  free_ = 9 * kMiB;
  EXPECT_TRUE(becomes(*disk, DiskState::kFull));
  free_ = 500 * kMiB;
  std::this_thread::sleep_for(milliseconds(30));
  EXPECT_EQ(disk->state(), DiskState::kFull) << "the scan is over";
  EXPECT_EQ(ended_, 1);
}

TEST_F(Guarded, a_full_disk_is_known_before_the_first_burst) {
  free_ = kMiB;
  const auto disk = guard();
  EXPECT_EQ(disk->state(), DiskState::kFull);
  EXPECT_EQ(ended_, 1);
}

TEST_F(Guarded, space_is_held_back_and_given_to_the_results) {
  auto disk = guard();
  const std::string reserve = folder_ / ".reserve";
  EXPECT_TRUE(fs::exists(reserve));
  disk->release_reserve();
  EXPECT_FALSE(fs::exists(reserve));
  disk.reset();
  disk = guard();
  EXPECT_TRUE(fs::exists(reserve));
  disk.reset();
  EXPECT_FALSE(fs::exists(reserve)) << "nothing is left behind";
}

}  // namespace
}  // namespace enamel::host
