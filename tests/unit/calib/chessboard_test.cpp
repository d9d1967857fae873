// Real pictures of chessboards, taken and published by others. Skipped where these are absent.
#include "calib/target/chessboard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "calib/solve/lens_start.hpp"
#include "tests/support/shared_data.hpp"

namespace enamel::calib {
namespace {

const std::string kPictures = test::shared_folder() + "/data/calib/opencv_stereo_chessboard";

std::vector<PlaneView> left_views(const TargetDesign& board) {
  std::vector<PlaneView> views;
  for (int n = 1; n <= 14; ++n) {
    char name[32];
    std::snprintf(name, sizeof name, "/left%02d.jpg", n);
    const cv::Mat picture = cv::imread(kPictures + name, cv::IMREAD_GRAYSCALE);
    if (picture.empty()) continue;
    Map<float> image(picture.cols, picture.rows);
    for (int v = 0; v < picture.rows; ++v)
      for (int u = 0; u < picture.cols; ++u) image(u, v) = static_cast<float>(picture.at<unsigned char>(v, u));
    const auto corners = find_chessboard(image, board);
    if (!corners) continue;
    PlaneView view{.name = name, .target_mm = {}, .image_px = {}};
    for (const BoardCorner& c : *corners) {
      view.target_mm.emplace_back(board.place(c.index).head<2>());
      view.image_px.push_back(c.image_px);
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(Chessboard, real_camera_is_solved_by_both_starts) {
  if (!std::filesystem::exists(kPictures)) GTEST_SKIP() << kPictures << " is absent";
  const TargetDesign board{
      .type = TargetType::kChessboard, .cols = 9, .rows = 6, .pitch_mm = 25, .radius_mm = 0, .marks = {}};
  const auto views = left_views(board);
  ASSERT_EQ(views.size(), 13U);
  const LensValues design{640, 480, 600, 600, 319.5, 239.5, {}};
  for (const auto& start : {zhang_start(views, design), rac_start(views, design)}) {
    ASSERT_TRUE(start) << start.error().message();
    EXPECT_LE(start->rms_px, 0.20) << start->method;
    EXPECT_NEAR(start->lens.fx, 533.0, 0.002 * 533) << start->method;
    EXPECT_NEAR(start->lens.fy, 533.0, 0.002 * 533) << start->method;
  }
  EXPECT_NEAR(zhang_start(views, design)->rms_px, rac_start(views, design)->rms_px, 1e-3) << "one minimum, two ways";
}

TEST(Chessboard, a_picture_without_one_says_so) {
  const TargetDesign board{
      .type = TargetType::kChessboard, .cols = 9, .rows = 6, .pitch_mm = 25, .radius_mm = 0, .marks = {}};
  EXPECT_EQ(find_chessboard(Map<float>(320, 240, 80.0F), board).error().code, ErrorCode::kTargetNotFound);
}

}  // namespace
}  // namespace enamel::calib
