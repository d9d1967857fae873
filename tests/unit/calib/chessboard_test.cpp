// Real pictures of chessboards, taken and published by others. Skipped where these are absent.
#include "calib/target/chessboard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "calib/solve/board_view.hpp"
#include "calib/solve/camera_alone.hpp"
#include "calib/solve/lens_start.hpp"
#include "calib/solve/solve.hpp"
#include "tests/support/procam_set.hpp"
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

TEST(Chessboard, camera_alone_is_solved_from_pictures) {
  if (!std::filesystem::exists(kPictures)) GTEST_SKIP() << kPictures << " is absent";
  std::vector<std::pair<std::string, std::string>> pictures;
  for (int n = 1; n <= 14; ++n) {
    char name[32];
    std::snprintf(name, sizeof name, "left%02d.jpg", n);
    if (n != 10) pictures.emplace_back(name, kPictures + "/" + name);
  }
  TargetDesign board;
  board.type = TargetType::kChessboard;
  board.cols = 9;
  board.rows = 6;
  board.pitch_mm = 25;
  const auto camera = solve_camera(pictures, board);
  ASSERT_TRUE(camera) << camera.error().message();
  EXPECT_EQ(camera->poses.size(), 13U);
  EXPECT_TRUE(camera->rejected.empty());
  EXPECT_LE(camera->start.rms_px, 0.20);
  EXPECT_NEAR(camera->start.lens.fx, 533.0, 0.002 * 533);
  EXPECT_NEAR(camera->start.lens.fy, 533.0, 0.002 * 533);
  board.cols = 12;
  const auto other = solve_camera(pictures, board);
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, ErrorCode::kTargetNotFound);
}

TEST(Chessboard, captured_projector_and_camera_under_gray_code) {
  const std::string folder = test::procam_folder(test::shared_folder());
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  std::vector<std::pair<std::string, std::string>> pictures;
  for (int n = 0; n < 5; ++n) {
    const std::string pose = "pose" + std::to_string(n);
    pictures.emplace_back(pose, folder + "/" + pose + "/white_full.png");
  }
  const auto set = test::load_procam(folder);
  ASSERT_TRUE(set) << set.error().message();
  ASSERT_EQ(set->views.size(), 5U);
  const auto camera = solve_camera(pictures, set->board);
  ASSERT_TRUE(camera) << camera.error().message();
  for (const double f : {camera->start.lens.fx, camera->start.lens.fy}) {
    EXPECT_GT(f, 3445 * (1 - 0.003));
    EXPECT_LT(f, 3452 * (1 + 0.003));
  }
  const auto solved = solve(set->views, set->board, set->nominal, test::procam_options());
  ASSERT_TRUE(solved) << solved.error().message();
  EXPECT_TRUE(solved->is_shape_solved) << "a corner of this board is bent";
  EXPECT_LE(std::hypot(solved->result.rms_camera_px, solved->result.rms_projector_px) / std::sqrt(2.0), 0.30);
  // The bent corner moves the focal length of a board that is taken as flat.
  EXPECT_NEAR(solved->state.camera.fx, camera->start.lens.fx, 0.005 * 3445);
}

TEST(Chessboard, squares_around_a_corner_give_its_projector_coordinates) {
  TargetDesign board;
  board.type = TargetType::kChessboard;
  board.cols = 4;
  board.rows = 3;
  board.pitch_mm = 10;
  const auto projector = [](double u, double v) {
    return Eigen::Vector2d(1.3 * u + 0.2 * v + 1e-4 * u * v, 0.9 * v - 0.1 * u + 2e-4 * v * v);
  };
  CoordinateMap along_u{Map<float>(320, 240), Map<float>(320, 240, 0.01F)}, along_v = along_u;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      along_u.value_px(u, v) = static_cast<float>(projector(u, v).x());
      along_v.value_px(u, v) = static_cast<float>(projector(u, v).y());
    }
  }
  std::vector<BoardCorner> corners;
  for (int i = 0; i < board.size(); ++i)
    corners.push_back({i, {80.3 + 40 * board.grid(i).col, 60.7 + 38 * board.grid(i).row}});
  // Around corner 5 nothing is decoded: it must be left out, not guessed.
  for (int v = 60 + 38 - 25; v < 60 + 38 + 25; ++v)
    for (int u = 80 + 40 - 25; u < 80 + 40 + 25; ++u) along_u.value_px(u, v) = std::nanf("");
  const PoseView pose = board_view("a", corners, board, along_u, along_v);
  ASSERT_EQ(pose.dots.size(), corners.size() - 1);
  for (const DotView& dot : pose.dots) {
    EXPECT_NE(dot.dot, 5);
    EXPECT_LT((dot.map.projector_px - projector(dot.camera_px.x(), dot.camera_px.y())).norm(), 1e-3) << dot.dot;
  }
}

TEST(Chessboard, a_picture_without_one_says_so) {
  const TargetDesign board{
      .type = TargetType::kChessboard, .cols = 9, .rows = 6, .pitch_mm = 25, .radius_mm = 0, .marks = {}};
  EXPECT_EQ(find_chessboard(Map<float>(320, 240, 80.0F), board).error().code, ErrorCode::kTargetNotFound);
}

}  // namespace
}  // namespace enamel::calib
