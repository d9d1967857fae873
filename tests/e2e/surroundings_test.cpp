// The machine around the program: language, time zone, rights, cores, a display that is gone, settings of others.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/e2e/live_scan.hpp"

namespace enamel::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

class Surroundings : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({program("enamel"), "capture", "cut", small_capture(), few_, "--last", "3"}).code, 0);
    plain_ = hash_of(replay(""));
    ASSERT_FALSE(plain_.empty());
  }
  /// `before`: what stands in front of the command, in the shell's words.
  std::string replay(const std::string& before, const std::string& options = "") {
    const std::string out = tmp_ / ("out" + std::to_string(runs_++));
    const Ran ran = shell(before + " '" + program("enamel") + "' replay '" + few_ + "' --out '" + out +
                          "' --headless --fast " + options);
    EXPECT_EQ(ran.code, 0) << before << ran.err;
    return out;
  }
  static std::string hash_of(const std::string& out) { return report_of(out).value("hash", std::string()); }
  TempFolder tmp_;
  std::string few_ = tmp_ / "few.mcap", plain_;
  int runs_ = 0;
};

TEST_F(Surroundings, numbers_stay_the_same_where_people_write_decimal_commas) {
  const std::string locale = "LOCPATH='" + (tmp_ / "") + "' LC_ALL=de_DE.UTF-8";
  if (shell("localedef -i de_DE -f UTF-8 '" + (tmp_ / "de_DE.UTF-8") + "'").code != 0)
    GTEST_SKIP() << "no sources of locales here (Debian: locales)";
  // Control: the locale is in force.
  EXPECT_EQ(shell(locale + " /usr/bin/printf '%.1f' 1,5").out, "1,5");
  const std::string out = replay(locale);
  EXPECT_EQ(hash_of(out), plain_);
  const auto row = read_file(out + "/poses.csv").value_or("");
  EXPECT_EQ(row, read_file(tmp_ / "out0/poses.csv").value_or("none"));
  const Ran config = shell(locale + " '" + program("enamel") + "' config");
  EXPECT_EQ(config.out, shell("'" + program("enamel") + "' config").out);
  EXPECT_EQ(shell(locale + " '" + program("enamel") + "' scan --headless --wait-seconds 0.5 --no-record --session '" +
                  (tmp_ / "s") + "' --dds-tag " + unique_tag())
                .code,
            3)
      << "half a second without a probe";
}

TEST_F(Surroundings, time_zone_rights_and_an_empty_environment_change_nothing) {
  for (const std::string before : {"TZ=Pacific/Kiritimati", "TZ=:nonsense", "umask 077;", "umask 000;", "env -i",
                                   "env -u HOME LANG=xx_YY.nonsense"}) {
    EXPECT_EQ(hash_of(replay(before)), plain_) << before;
  }
}

TEST_F(Surroundings, one_core_or_sixty_four_workers_give_the_same_bits) {
  EXPECT_EQ(hash_of(replay("taskset -c 0")), plain_);
  EXPECT_EQ(hash_of(replay("", "--threads 64")), plain_);
}

TEST_F(Surroundings, nobody_scans_as_well_as_root) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become nobody";
  fs::permissions(tmp_.path(), fs::perms::all);
  fs::permissions(few_, fs::perms::all);
  if (shell("setpriv --reuid=65534 --regid=65534 --clear-groups '" + program("enamel") + "' --version").code != 0)
    GTEST_SKIP() << "nobody may not enter the folder of the build";
  const std::string out = replay("HOME=/nonexistent setpriv --reuid=65534 --regid=65534 --clear-groups");
  EXPECT_EQ(hash_of(out), plain_);
}

TEST_F(Surroundings, a_display_that_is_gone_is_said_at_once) {
  for (const std::string display : {"localhost:99", "/no/such", ":4711"}) {
    const Ran ran = shell("DISPLAY='" + display + "' WAYLAND_DISPLAY= '" + program("enamel") + "' replay '" + few_ +
                              "' --view --out '" + (tmp_ / "view") + "'",
                          seconds(20));
    EXPECT_EQ(ran.code, 3) << display << ran.err;
    EXPECT_NE(ran.err.find("--headless"), std::string::npos) << ran.err;
    EXPECT_FALSE(fs::exists(tmp_ / "view/mesh.ply")) << "not after the work";
  }
}

TEST_F(Surroundings, settings_of_other_dds_programs_do_not_bend_a_scan) {
  ASSERT_TRUE(write_file(tmp_ / "ros.xml",
                         "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface name=\"nowhere0\"/>"
                         "</Interfaces></General></Domain></CycloneDDS>"));
  ASSERT_TRUE(write_file(tmp_ / "broken.xml", "<CycloneDDS><Domain"));
  const std::vector<std::string> uris{"file://" + (tmp_ / "ros.xml"), "file://" + (tmp_ / "broken.xml"),
                                      "file://" + (tmp_ / "none.xml"), std::string("<General><NotKnown/></General>")};
  for (const std::string& uri : uris) {
    const Ran ran =
        shell("CYCLONEDDS_URI='" + uri + "' ROS_DOMAIN_ID=900 '" + program("enamel") +
                  "' scan --headless --wait-seconds 1 --session '" + (tmp_ / "scan") + "' --dds-tag " + unique_tag(),
              seconds(30));
    EXPECT_EQ(ran.code, 3) << uri << ran.err;
    EXPECT_NE(ran.err.find("what to do"), std::string::npos) << ran.err;
  }
}

}  // namespace
}  // namespace enamel::test
