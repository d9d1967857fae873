// enamel-updated as a process, without USB: what it says before it has an endpoint. The guest lane has the rest.
#include <gtest/gtest.h>

#include <filesystem>

#include "firmware/boot/flash_map.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

class Updater : public testing::Test {
 protected:
  Updater() {
    EXPECT_TRUE(write_file(flash_, "").has_value());
    std::filesystem::resize_file(flash_, fw::flash_map::kSize);
  }
  [[nodiscard]] Ran start(const std::string& flash, const std::string& serial = "EN2-1") const {
    return run({program("enamel-updated"), "--flash", flash, "--functionfs", folder_ / "ffs", "--serial", serial,
                "--hw-rev", "2"});
  }

  TempFolder folder_;
  std::string flash_ = folder_ / "flash";
};

TEST_F(Updater, without_firmware_waits_in_recovery_and_names_the_missing_mount) {
  const Ran r = start(flash_);
  EXPECT_EQ(r.code, 2) << r.err;
  EXPECT_NE(r.err.find("waiting for an image"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("no FunctionFS is mounted there"), std::string::npos) << r.err;
}

TEST_F(Updater, refuses_what_it_cannot_use) {
  EXPECT_EQ(start(folder_ / "absent").code, 2);
  EXPECT_TRUE(write_file(folder_ / "small", "too small").has_value());
  EXPECT_EQ(start(folder_ / "small").code, 3);
  EXPECT_EQ(start(flash_, "seventeen-letters").code, 1);
}

TEST_F(Updater, explains_itself) {
  const Ran r = run({program("enamel-updated"), "--help"});
  EXPECT_EQ(r.code, 0);
  for (const char* word : {"--flash", "--functionfs", "--slot", "Exit codes"}) {
    EXPECT_NE(r.out.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace enamel::test
