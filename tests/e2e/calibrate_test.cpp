// `enamel calibrate` as a process, on a set of our own making: accepted, refused, named, never half-written.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calib/io/rig_writer.hpp"
#include "tests/e2e/calibrate_set.hpp"
#include "tests/support/rig_files.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared_data.hpp"

namespace enamel {
namespace {

namespace fs = std::filesystem;

class Calibrate : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    set_ = std::make_unique<test::TempFolder>();
    write_set(set_->path().string());
  }
  static void TearDownTestSuite() { set_.reset(); }

  /// A copy of the set for a test to spoil.
  std::string copy() const {
    fs::copy(set_->path(), own_.path() / "set", fs::copy_options::recursive);
    return own_ / "set";
  }
  std::string rig() const { return own_ / "rig.json"; }
  test::Ran solve(const std::string& folder, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> argv{test::program("enamel"), "calibrate", "solve", folder, "--out", rig(), "--json"};
    argv.insert(argv.end(), more.begin(), more.end());
    return test::run(argv, std::chrono::seconds(300));
  }
  /// Another subcommand with the test's own store.
  test::Ran with_store(const std::string& command, std::vector<std::string> more) const {
    more.insert(more.begin(), {test::program("enamel"), "calibrate", command, "--store", own_ / "store"});
    return test::run(more);
  }
  static void edit(const std::string& path, const std::string& from, const std::string& to) {
    std::string text = read_file(path).value();
    ASSERT_NE(text.find(from), std::string::npos);
    ASSERT_TRUE(write_file(path, text.replace(text.find(from), from.size(), to)));
  }
  static void expect_message(const test::Ran& ran, const std::string& says) {
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_THAT(ran.err, testing::HasSubstr(says));
  }
  void expect_refused(const test::Ran& ran, const std::string& says) const {
    EXPECT_EQ(ran.code, 2) << ran.err;
    EXPECT_THAT(ran.err, testing::HasSubstr(says));
    EXPECT_THAT(ran.err, testing::HasSubstr("what to do"));
    EXPECT_FALSE(fs::exists(rig()));
  }

  static std::unique_ptr<test::TempFolder> set_;
  test::TempFolder own_;
};
std::unique_ptr<test::TempFolder> Calibrate::set_;

TEST_F(Calibrate, five_poses_are_accepted_and_one_without_a_fringe_image_is_named) {
  const std::string folder = copy();
  fs::remove(folder + "/poses/02/v_16_3.png");
  const auto ran = solve(folder);
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["verdict"], "accepted");
  EXPECT_EQ(json["poses_used"], kPoses - 1);
  ASSERT_EQ(json["poses_rejected"].size(), 1U);
  EXPECT_EQ(json["poses_rejected"][0]["pose"], "02");
  EXPECT_THAT(json["poses_rejected"][0]["reason"].get<std::string>(), testing::HasSubstr("v_16_3.png is missing"));
  EXPECT_EQ(json["sag_um"].size(), 3U);
  EXPECT_EQ(json["twist_um"].size(), 3U);
  const std::string text = read_file(rig()).value();
  EXPECT_TRUE(calib::parse_rig(text));
  EXPECT_TRUE(calib::is_rig_intact(text));
}

/// Pictures of eight grey levels of a projector with an exponent.
void write_response(const std::string& folder, double gamma) {
  fs::create_directories(folder + "/response");
  for (int level = 0; level <= 255; level += 51)
    test::write_png(folder + "/response/grey_" + std::to_string(level) + ".png",
                    Map<float>(640, 480, static_cast<float>(std::round(4 + 200 * std::pow(level / 255.0, gamma)))));
}

TEST_F(Calibrate, projector_that_is_not_linear_is_refused_before_anything_is_solved) {
  const std::string folder = copy();
  write_response(folder, 2.0);
  const auto bent = solve(folder);
  EXPECT_EQ(bent.code, 6);
  EXPECT_THAT(bent.err, testing::HasSubstr("off a straight line by 24 % of full scale, limit 5 %"));
  EXPECT_FALSE(fs::exists(rig()));
  write_response(folder, 1.08);
  const auto straight = solve(folder);
  EXPECT_EQ(straight.code, 0) << straight.err;
  EXPECT_THAT(read_file(rig()).value(), testing::HasSubstr("\"emission\""));
}

/// The pictures of frame_0 … frame_3 in `folder`, one after the other.
std::string pictures(const std::string& folder) {
  std::string all;
  for (int k = 0; k < 4; ++k) all += read_file(folder + "/frame_" + std::to_string(k) + ".png").value_or("");
  return all;
}

TEST_F(Calibrate, patterns_for_the_projector_undo_the_response_that_was_measured) {
  const std::string folder = copy();
  write_response(folder, 1.08);
  ASSERT_EQ(solve(folder).code, 0);
  nlohmann::json own = nlohmann::json::parse(read_file(folder + "/rig.json").value());
  own["patterns"] = {{"mode", "T"}, {"period_px", 24}, {"polarity_code", "-++++-+---++---+"}};
  const std::string probe = own_ / "probe.json";
  ASSERT_TRUE(write_file(probe, own.dump()));
  const auto patterns = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {test::program("enamel"), "patterns", "--json"});
    return test::run(more);
  };
  const auto plain = patterns({probe, own_ / "plain"});
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_EQ(nlohmann::json::parse(plain.out)["linearised"], false);
  const auto linear = patterns({probe, own_ / "linear", "--calibration", rig()});
  ASSERT_EQ(linear.code, 0) << linear.err;
  const auto json = nlohmann::json::parse(linear.out);
  EXPECT_EQ(json["linearised"], true);
  EXPECT_EQ(json["mode"], "T");
  EXPECT_EQ(read_file(own_ / "linear/patterns.json").value(), linear.out);
  const auto picture = cv::imread(own_ / "linear/frame_0.png", cv::IMREAD_GRAYSCALE);
  ASSERT_EQ(picture.size(), cv::Size(own["projector"]["width"], own["projector"]["height"]));
  // Pixel 6 wants the mean, 127.5 of 255: a projector of exponent 1.08 emits it at level 134.2.
  EXPECT_NEAR(picture.at<std::uint8_t>(100, 6), 255 * std::pow(0.5, 1 / 1.08), 1.5);
  EXPECT_NE(pictures(own_ / "linear"), pictures(own_ / "plain"));
  const auto multi = patterns({rig(), own_ / "none"});
  EXPECT_EQ(multi.code, 2);
  EXPECT_THAT(multi.err, testing::HasSubstr("give the probe's own rig"));
  EXPECT_FALSE(fs::exists(own_ / "none"));
  own["patterns"] = {{"mode", "M"}, {"period_px", 24}, {"code_ratio", 4}};
  ASSERT_TRUE(write_file(probe, own.dump()));
  const auto alike = patterns({probe, own_ / "none"});
  EXPECT_EQ(alike.code, 2);
  EXPECT_THAT(alike.err, testing::HasSubstr("code_ratio 4 repeats within the 6 fringe orders"));
  EXPECT_FALSE(fs::exists(own_ / "none"));
}

TEST_F(Calibrate, accepted_one_is_installed_listed_shown_and_reported) {
  const std::string folder = copy();
  const auto ran = solve(folder, {"--install", "--store", own_ / "store", "--report", own_ / "report"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(read_file(own_ / "report/calibration.html").value(), testing::HasSubstr("class=\"verdict accepted\""));
  const auto report = nlohmann::json::parse(read_file(own_ / "report/calibration.json").value());
  EXPECT_EQ(report["poses"].size(), static_cast<std::size_t>(kPoses));
  EXPECT_EQ(report["parameters"].size(), 22U);
  EXPECT_EQ(report["residuals"]["rows"].size(), 63U * kPoses);
  const auto list = nlohmann::json::parse(with_store("list", {"--json"}).out);
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0]["serial"], "EN-11");
  EXPECT_TRUE(list[0]["current"]);
  EXPECT_EQ(read_file(list[0]["path"]).value(), read_file(rig()).value());
  const auto reverted = with_store("revert", {"EN-11"});
  EXPECT_EQ(reverted.code, 2);
  EXPECT_THAT(reverted.err, testing::HasSubstr("is the oldest"));
  const auto shown =
      nlohmann::json::parse(test::run({test::program("enamel"), "calibrate", "show", rig(), "--json"}).out);
  EXPECT_EQ(shown["verdict"], "accepted");
  EXPECT_EQ(shown["sha256"], "valid");
  edit(rig(), "\"width\": 640", "\"width\": 641");
  const auto changed = test::run({test::program("enamel"), "calibrate", "show", rig()});
  EXPECT_EQ(changed.code, 2);
  EXPECT_THAT(changed.out, testing::HasSubstr("changed after solving"));
}

TEST_F(Calibrate, a_set_of_another_probe_is_refused_before_it_is_measured) {
  const auto ran = solve(copy(), {"--serial", "EN-12"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, testing::AllOf(testing::HasSubstr("EN-11"), testing::HasSubstr("EN-12")));
  EXPECT_FALSE(fs::exists(rig()));
}

TEST_F(Calibrate, dark_frames_and_flat_field_are_used) {
  const std::string folder = copy();
  for (const char* name : {"/dark_0.png", "/dark_1.png"}) test::write_png(folder + name, Map<float>(640, 480, 4.0F));
  test::write_png(folder + "/flat.png", Map<float>(640, 480, 180.0F));
  const auto ran = solve(folder);
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_THAT(ran.out,
              testing::AllOf(testing::HasSubstr("2 dark frames subtracted"), testing::HasSubstr("flat field divided")));
  test::write_png(folder + "/flat.png", Map<float>(640, 480, 255.0F));
  expect_message(solve(folder), "flat.png is saturated");
}

TEST_F(Calibrate, metres_for_millimetres_are_refused) {
  const std::string folder = copy();
  edit(folder + "/target.json", R"("pitch_mm": 1.8, "radius_mm": 0.33)", R"("pitch_mm": 0.0018, "radius_mm": 0.00033)");
  expect_refused(solve(folder), "pitch_mm 0.0018 puts the target");
}

TEST_F(Calibrate, another_target_is_refused_with_both_sizes) {
  const std::string folder = copy();
  edit(folder + "/target.json", R"("cols": 9)", R"("cols": 11)");
  expect_refused(solve(folder), "a grid of 9 x 7 dots is in view, target.json says 11 x 7");
}

TEST_F(Calibrate, an_older_rig_stays_when_the_new_one_is_refused) {
  const std::string folder = copy();
  for (const char* pose : {"02", "03", "04"}) fs::remove_all(folder + "/poses/" + pose);
  ASSERT_TRUE(write_file(rig(), "older"));
  const auto ran = solve(folder);
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.err, testing::HasSubstr("2 usable poses"));
  EXPECT_EQ(read_file(rig()).value(), "older");
}

TEST_F(Calibrate, rig_of_another_serial_or_changed_by_hand_is_refused_by_check) {
  const std::string folder = copy();
  ASSERT_EQ(solve(folder).code, 0);
  const std::vector<std::string> check{test::program("enamel"), "calibrate", "check", folder, "--rig", rig()};
  edit(folder + "/rig.json", "EN-11", "EN-12");
  const auto foreign = test::run(check);
  EXPECT_EQ(foreign.code, 2);
  EXPECT_THAT(foreign.err, testing::AllOf(testing::HasSubstr("EN-11"), testing::HasSubstr("EN-12")));
  edit(rig(), "\"width\": 640", "\"width\": 641");
  const auto changed = test::run(check);
  EXPECT_EQ(changed.code, 2);
  EXPECT_THAT(changed.err, testing::HasSubstr("sha256"));
}

TEST_F(Calibrate, steps_are_told_and_none_makes_planes_worse) {
  const auto ran = solve(set_->path().string());
  ASSERT_EQ(ran.code, 0) << ran.err;
  const auto steps = nlohmann::json::parse(ran.out)["steps"];
  ASSERT_GE(steps.size(), 3U);
  EXPECT_EQ(steps[0]["step"], "start");
  EXPECT_EQ(steps[2]["step"], "global");
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const double sigma = steps[k]["plane_rms_sigma_um"];
    EXPECT_LE(steps[k]["plane_rms_um"].get<double>(), steps[k - 1]["plane_rms_um"].get<double>() + sigma);
  }
}

/// The balls of the rendered burst of another program: diameters 5 and 6 mm, 8 mm apart.
TEST(CalibrateBar, true_rig_measures_the_bar_and_a_wrong_length_is_refused) {
  const std::string spheres = test::shared_folder() + "/data/oracle/spheres-01";
  if (!fs::exists(spheres + "/rig.json")) GTEST_SKIP() << spheres << " is absent";
  const auto check = [&](const char* design) {
    return test::run({test::program("enamel"), "calibrate", "check", "--rig", spheres + "/rig.json", "--bar", spheres,
                      "--bar-mm", design});
  };
  const auto good = check("5,6,8");
  EXPECT_EQ(good.code, 0) << good.err << good.out;
  const auto burst = nlohmann::json::parse(good.out)["bursts"][0];
  EXPECT_LT(std::abs(burst["larger"]["off_um"].get<double>()), 5);
  EXPECT_LT(burst["larger"]["form_p95_um"].get<double>(), 15);
  const auto bad = check("5,6,8.02");
  EXPECT_EQ(bad.code, 6);
  EXPECT_THAT(bad.out, testing::HasSubstr("the distance of the spheres is off by -20"));
  EXPECT_EQ(check("5,6").code, 1);
}

}  // namespace
}  // namespace enamel
