// The real GLFW window on a display of its own.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "protocol/base/latest_slot.hpp"
#include "tests/unit/viewer/picture_probe.hpp"
#include "tests/unit/viewer/screen_grab.hpp"
#include "tests/unit/viewer/tooth_scene.hpp"
#include "tests/unit/viewer/xvfb.hpp"
#include "viewer/gl/viewer_window.hpp"

namespace enamel::view::test {
namespace {

class WindowTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { display_ = std::make_unique<Xvfb>(); }
  static void TearDownTestSuite() { display_.reset(); }

  void SetUp() override {
    if (!display_->problem().empty()) {
      GTEST_SKIP() << display_->problem();
    }
    auto window = ViewerWindow::open(options_, clock_);
    ASSERT_TRUE(window) << window.error().message();
    window_ = std::move(*window);
  }

  /// What the X server shows after this frame.
  Picture shown(std::shared_ptr<const PreviewFrame> frame) {
    EXPECT_TRUE(window_->render(std::move(frame)));
    Picture picture = grab_screen();
    EXPECT_EQ(picture.width, options_.width);
    return picture;
  }

  static std::unique_ptr<Xvfb> display_;
  ManualClock clock_;
  ViewerOptions options_;
  std::unique_ptr<ViewerWindow> window_;
  ToothScene scene_;
};

std::unique_ptr<Xvfb> WindowTest::display_;

TEST_F(WindowTest, growing_model_reaches_the_screen_in_one_draw_call) {
  std::shared_ptr<PreviewFrame> frame;
  LatestSlot<std::shared_ptr<const PreviewFrame>> mailbox;
  std::size_t before = 0;
  for (int i = 0; i < 20; ++i) {
    frame = scene_.frame(i, 20, frame.get());
    mailbox.put(frame);
    const UserCommands commands = window_->poll();
    EXPECT_FALSE(commands.quit || commands.toggle_scan || commands.save_picture);
    ASSERT_TRUE(window_->render(mailbox.take().value_or(nullptr)));
    clock_.advance(Nanoseconds{50'000'000});
    EXPECT_GE(window_->stats().triangles, before);
    before = window_->stats().triangles;
  }
  std::size_t expected = 0;
  for (const auto& block : frame->model->blocks) {
    expected += block->triangles.size();
  }
  const ViewerStats stats = window_->stats();
  EXPECT_EQ(stats.frames_drawn, 20U);
  EXPECT_EQ(stats.triangles, expected);
  EXPECT_EQ(stats.blocks_pending, 0U);
  EXPECT_EQ(stats.draw_calls, 1);
  const Picture on_screen = grab_screen();
  EXPECT_GT(share_of(on_screen, kMiddle, is_tooth), 0.10);
  EXPECT_LT(outline_distance(on_screen, kGood), 60);
}

TEST_F(WindowTest, empty_model_shows_no_tooth_pixel) {
  auto frame = scene_.frame(12, 20);
  frame->model = nullptr;
  EXPECT_LT(share_of(shown(frame), kMiddle, is_tooth), 0.0005);
}

TEST_F(WindowTest, blocks_that_leave_the_model_leave_the_screen) {
  const auto full = scene_.frame(12, 20);
  EXPECT_GT(share_of(shown(full), kMiddle, is_tooth), 0.10);
  auto emptied = std::make_shared<PreviewFrame>(*full);
  emptied->model = std::make_shared<ModelSnapshot>();
  EXPECT_LT(share_of(shown(emptied), kMiddle, is_tooth), 0.0005);
}

TEST_F(WindowTest, probe_field_is_drawn_and_can_be_switched_off) {
  const auto frame = scene_.frame(12, 20);
  window_->toggles().trail = false;
  const double with = share_of(shown(frame), kMiddle, is_green);
  window_->toggles().frustum = false;
  const double without = share_of(shown(std::make_shared<PreviewFrame>(*frame)), kMiddle, is_green);
  EXPECT_GT(with, without + 0.003);
  EXPECT_LT(without, 0.0005);
}

TEST_F(WindowTest, soft_tissue_is_drawn_and_can_be_hidden) {
  auto frame = std::make_shared<PreviewFrame>(*scene_.frame(12, 20));
  frame->model = half_soft(*frame->model);
  const double with = share_of(shown(frame), kMiddle, is_gum);
  window_->toggles().soft_tissue = false;
  const double without = share_of(shown(std::make_shared<PreviewFrame>(*frame)), kMiddle, is_gum);
  EXPECT_GT(with, 0.03);
  EXPECT_LT(without, 0.1 * with);
}

TEST_F(WindowTest, live_image_is_the_one_of_the_frame) {
  auto frame = scene_.frame(3, 20);
  frame->live = std::make_shared<Map<std::uint8_t>>(320, 240, std::uint8_t{200});
  EXPECT_NEAR(mean_level(shown(frame), kLiveCorner), 200, 12);
  auto dark = std::make_shared<PreviewFrame>(*frame);
  dark->live = std::make_shared<Map<std::uint8_t>>(160, 120, std::uint8_t{60});
  EXPECT_NEAR(mean_level(shown(dark), kLiveCorner), 60, 12);
}

TEST_F(WindowTest, outline_says_the_tracking_state) {
  auto frame = scene_.frame(8, 20);
  EXPECT_LT(outline_distance(shown(frame), kGood), 60);
  auto lost = std::make_shared<PreviewFrame>(*frame);
  lost->track = TrackState::kLost;
  const Picture picture = shown(lost);
  EXPECT_LT(outline_distance(picture, kBad), 60);
  EXPECT_GT(outline_distance(picture, kGood), 100);
  auto found = std::make_shared<PreviewFrame>(*frame);
  found->track = TrackState::kRelocalised;
  EXPECT_LT(outline_distance(shown(found), kWeak), 60);
}

TEST_F(WindowTest, a_segment_apart_is_cold_and_the_place_to_return_to_is_shown_beside_it) {
  constexpr Region kReturn{0.03, 0.10, 0.21, 0.30};
  const auto whole = scene_.frame(19, 20);
  auto apart = scene_.frame(12, 20);
  apart->segment = 1;
  const double without = share_of(shown(apart), kReturn, is_tooth);
  EXPECT_LT(share_of(shown(apart), kMiddle, is_tooth), 0.01) << "not in the model's tone";
  auto with = std::make_shared<PreviewFrame>(*apart);
  with->whole = whole->model;
  with->T_model_return = whole->T_model_cam;
  EXPECT_GT(share_of(shown(with), kReturn, is_tooth), without + 0.05);
  auto joined = std::make_shared<PreviewFrame>(*scene_.frame(12, 20));
  const Picture back = shown(joined);
  EXPECT_GT(share_of(back, kMiddle, is_tooth), 0.10);
  EXPECT_LT(share_of(back, kReturn, is_tooth), without + 0.02);
}

TEST_F(WindowTest, same_frame_is_not_drawn_again_and_new_one_is) {
  const auto frame = scene_.frame(5, 20);
  ASSERT_TRUE(window_->render(frame));
  static_cast<void>(window_->poll());  // the window's own appearance is an event
  ASSERT_TRUE(window_->render(frame));
  const auto drawn = window_->stats().frames_drawn;
  ASSERT_TRUE(window_->render(frame));
  ASSERT_TRUE(window_->render(nullptr));
  EXPECT_EQ(window_->stats().frames_drawn, drawn);
  ASSERT_TRUE(window_->render(std::make_shared<PreviewFrame>(*frame)));
  EXPECT_EQ(window_->stats().frames_drawn, drawn) << "a session makes a frame each time that it is asked";
  auto next = std::make_shared<PreviewFrame>(*frame);
  ++next->counters.captured;
  ASSERT_TRUE(window_->render(std::move(next)));
  EXPECT_EQ(window_->stats().frames_drawn, drawn + 1);
}

TEST_F(WindowTest, picture_is_saved_as_png_and_says_who_drew_it) {
  ASSERT_TRUE(window_->render(scene_.frame(12, 20)));
  const auto taken = window_->screenshot();
  ASSERT_TRUE(taken) << taken.error().message();
  const Picture& picture = *taken;
  EXPECT_GT(share_of(picture, kMiddle, is_tooth), 0.10);
  EXPECT_EQ(picture.drawn_by.rfind("window", 0), 0U) << picture.drawn_by;
  const std::string path =
      (std::filesystem::temp_directory_path() / ("enamel_window_" + std::to_string(getpid()) + ".png")).string();
  ASSERT_TRUE(write_png(picture, path));
  const cv::Mat read = cv::imread(path);
  std::filesystem::remove(path);
  ASSERT_EQ(read.cols, options_.width);
  ASSERT_EQ(read.rows, options_.height);
  const Rgb want = pixel(picture, 640, 400);
  const cv::Vec3b have = read.at<cv::Vec3b>(400, 640);
  EXPECT_EQ((Rgb{have[2], have[1], have[0]}), want);
  EXPECT_EQ(write_png(picture, "/nonexistent/folder/x.png").error().code, ErrorCode::kFileWrite);
}

TEST_F(WindowTest, small_upload_budget_delays_blocks_but_loses_none) {
  options_.upload_budget_bytes = 120'000;
  window_.reset();
  auto window = ViewerWindow::open(options_, clock_);
  ASSERT_TRUE(window);
  window_ = std::move(*window);
  const auto frame = scene_.frame(15, 20);
  ASSERT_TRUE(window_->render(frame));
  EXPECT_GT(window_->stats().blocks_pending, 0U);
  EXPECT_LE(window_->stats().bytes_uploaded, 120'000U);
  for (int i = 0; i < 60 && window_->stats().blocks_pending > 0; ++i) {
    ASSERT_TRUE(window_->render(frame));
  }
  EXPECT_EQ(window_->stats().blocks_pending, 0U);
  std::size_t expected = 0;
  for (const auto& block : frame->model->blocks) {
    expected += block->triangles.size();
  }
  EXPECT_EQ(window_->stats().triangles, expected);
}

TEST(NoDisplay, open_says_what_is_missing_and_what_to_do) {
  const char* display = std::getenv("DISPLAY");
  const std::string kept = display != nullptr ? display : "";
  unsetenv("DISPLAY");
  SteadyClock clock;
  const auto window = ViewerWindow::open({}, clock);
  if (display != nullptr) {
    setenv("DISPLAY", kept.c_str(), 1);
  }
  ASSERT_FALSE(window);
  EXPECT_EQ(window.error().code, ErrorCode::kDisplay);
  EXPECT_NE(window.error().message().find("--headless"), std::string::npos);
}

}  // namespace
}  // namespace enamel::view::test
