// The real window on a real X server (Xvfb): a replay is shown while it runs, and the last picture comes from the
// window.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/e2e/small_capture.hpp"
#include "tests/support/run.hpp"

namespace enamel::test {
namespace {

/// Share of the picture, the left fifth and the panels left out, that has the warm colour of the model.
double model_share(const std::string& path) {
  const cv::Mat bgr = cv::imread(path);
  if (bgr.empty()) return -1;
  const cv::Mat middle = bgr(cv::Rect(bgr.cols / 4, bgr.rows / 8, bgr.cols / 2, bgr.rows * 3 / 4));
  int warm = 0;
  for (int v = 0; v < middle.rows; ++v) {
    for (int u = 0; u < middle.cols; ++u) {
      const auto& p = middle.at<cv::Vec3b>(v, u);
      warm += p[2] > 110 && p[2] > p[0] + 8 ? 1 : 0;
    }
  }
  return static_cast<double>(warm) / static_cast<double>(middle.total());
}

std::string drawn_by(const std::string& folder) {
  const auto report = nlohmann::json::parse(read_file(folder + "/report.json").value_or("{}"), nullptr, false);
  return report.value("/notes/picture"_json_pointer, std::string());
}

TEST(View, a_replay_is_shown_in_a_window_and_the_picture_is_the_windows) {
  const TempFolder tmp;
  const Ran ran = run({"/usr/bin/xvfb-run", "-a", "-s", "-screen 0 1280x800x24 -nolisten tcp", program("enamel"),
                       "replay", small_capture(), "--out", tmp / "out", "--view"},
                      std::chrono::seconds(180));
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(drawn_by(tmp / "out").rfind("drawn by window", 0), 0U) << drawn_by(tmp / "out");
  EXPECT_GT(model_share(tmp / "out/preview.png"), 0.1);
}

TEST(View, without_a_display_the_picture_is_drawn_all_the_same_and_says_so) {
  const TempFolder tmp;
  const Ran ran = run({program("enamel"), "replay", small_capture(), "--out", tmp / "out", "--headless"},
                      std::chrono::seconds(180));
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(drawn_by(tmp / "out").rfind("drawn by EGL surfaceless", 0), 0U) << drawn_by(tmp / "out");
  EXPECT_GT(model_share(tmp / "out/preview.png"), 0.1);
}

TEST(View, an_empty_picture_has_no_model_in_it) {  // negative control of model_share
  const TempFolder tmp;
  ASSERT_TRUE(cv::imwrite(tmp / "dark.png", cv::Mat(800, 1280, CV_8UC3, cv::Scalar(60, 50, 40))));
  EXPECT_LT(model_share(tmp / "dark.png"), 0.01);
}

}  // namespace
}  // namespace enamel::test
