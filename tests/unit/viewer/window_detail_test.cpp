// How many triangles a frame of a large model is made of, on a display of its own. No time is measured: the clock is
// told.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "tests/unit/viewer/picture_probe.hpp"
#include "tests/unit/viewer/tooth_scene.hpp"
#include "tests/unit/viewer/xvfb.hpp"
#include "viewer/gl/viewer_window.hpp"

namespace enamel::view::test {
namespace {

constexpr std::size_t kBudget = 20'000;

/// As on a busy machine: each look at the clock is 30 ms after the last one.
class SlowClock final : public Clock {
 public:
  [[nodiscard]] HostTime now() const override { return time_ += Nanoseconds{30'000'000}; }
  void sleep_until(HostTime time) override { time_ = std::max(time_, time); }

 private:
  mutable HostTime time_{};
};

class WindowDetailTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { display_ = std::make_unique<Xvfb>(); }
  static void TearDownTestSuite() { display_.reset(); }

  void SetUp() override {
    if (!display_->problem().empty()) {
      GTEST_SKIP() << display_->problem();
    }
    options_.triangle_budget = kBudget;
    reopen(clock_);
    static_cast<void>(window_->poll());
    model_ = scene_.frame(19, 20);
    for (const auto& block : model_->model->blocks) model_triangles_ += block->triangles.size();
  }

  void reopen(Clock& clock) {
    window_.reset();
    auto window = ViewerWindow::open(options_, clock);
    ASSERT_TRUE(window) << window.error().message();
    window_ = std::move(*window);
  }

  /// The model with the probe somewhere along the arch, 50 ms later by the clock that is told.
  void draw(double share) {
    auto frame = std::make_shared<PreviewFrame>(*model_);
    ++frame->burst.value;
    frame->T_model_cam = scene_.pose(share);
    model_ = frame;
    clock_.advance(Nanoseconds{50'000'000});
    ASSERT_TRUE(window_->render(std::move(frame)));
  }

  static std::unique_ptr<Xvfb> display_;
  ManualClock clock_;
  SlowClock slow_;
  ViewerOptions options_;
  std::unique_ptr<ViewerWindow> window_;
  const ToothScene scene_{.step_mm = 0.1, .block_mm = 0.8};
  std::shared_ptr<PreviewFrame> model_;
  std::size_t model_triangles_ = 0;
};

std::unique_ptr<Xvfb> WindowDetailTest::display_;

TEST_F(WindowDetailTest, moving_views_keep_the_budget_and_resting_ones_show_the_mesh_as_it_is) {
  ASSERT_GT(model_triangles_, 150'000U);
  for (int i = 0; i < 30; ++i) {
    draw(0.2 + 0.02 * i);
    if (i > 4) {
      EXPECT_LE(window_->stats().drawn_triangles, window_->stats().triangle_budget) << i;
    }
    EXPECT_FALSE(window_->stats().refined);
  }
  EXPECT_EQ(window_->stats().triangles, model_triangles_);
  EXPECT_GT(window_->stats().drawn_triangles, kBudget / 4) << "control: something is drawn";
  std::size_t frames = 0, most = 0;
  for (; frames < 200 && !window_->stats().refined; ++frames) {
    clock_.advance(Nanoseconds{50'000'000});
    ASSERT_TRUE(window_->render(model_));
    most = std::max(most, window_->stats().drawn_triangles);
  }
  EXPECT_TRUE(window_->stats().refined);
  EXPECT_LE(most, window_->stats().triangle_budget) << "in parts that each keep the budget";
  EXPECT_GT(frames, 6U) << "control: there were several";
  const std::uint64_t drawn = window_->stats().frames_drawn;
  ASSERT_TRUE(window_->render(model_));
  EXPECT_EQ(window_->stats().frames_drawn, drawn) << "what rests is not drawn again";
  draw(0.5);
  EXPECT_FALSE(window_->stats().refined);
}

TEST_F(WindowDetailTest, coarse_and_fine_pictures_are_of_the_same_model) {
  for (int i = 0; i < 8; ++i) draw(0.5);
  const auto fine = window_->screenshot();
  ASSERT_TRUE(fine);
  EXPECT_GE(window_->stats().drawn_triangles, model_triangles_ / 3) << "control: a saved picture has no budget";
  EXPECT_GT(share_of(*fine, kMiddle, is_tooth), 0.1);
  draw(0.51);
  EXPECT_LE(window_->stats().drawn_triangles, window_->stats().triangle_budget);
}

TEST_F(WindowDetailTest, without_a_budget_the_mesh_is_drawn_as_it_is) {
  options_.triangle_budget = DetailBudget::kMost;
  reopen(clock_);
  for (int i = 0; i < 8; ++i) draw(0.5);
  EXPECT_GT(window_->stats().drawn_triangles, 4 * kBudget);
}

TEST_F(WindowDetailTest, drawing_keeps_its_share_of_the_time_and_events_are_handled_between) {
  options_.max_busy_share = 0.05;
  reopen(slow_);
  int due = 0, early = 0;
  for (int i = 0; i < 40; ++i) {
    const HostTime before = slow_.now();
    if (!window_->wait_frame()) {
      ++early;
      EXPECT_LE(slow_.now() - before, Nanoseconds{150'000'000}) << "the person does not wait";
      continue;
    }
    ++due;
    ++model_->burst.value;
    ASSERT_TRUE(window_->render(std::make_shared<PreviewFrame>(*model_)));
  }
  EXPECT_EQ(window_->stats().frames_drawn, static_cast<std::uint64_t>(due));
  EXPECT_GT(due, 4);
  EXPECT_GE(early, 3 * due) << "30 ms a frame at a twentieth of the time: the next one is 600 ms later";
}

TEST_F(WindowDetailTest, a_slow_machine_draws_fewer_pixels_until_the_view_rests) {
  for (int i = 0; i < 8; ++i) draw(0.5);
  const auto quick = window_->screenshot();
  ASSERT_TRUE(quick);
  EXPECT_EQ(window_->stats().sharpness, 1) << "control: no time passes by that clock";
  reopen(slow_);
  for (int i = 0; i < 30; ++i) draw(0.2 + 0.01 * i);
  EXPECT_EQ(window_->stats().sharpness, 0.5);
  for (int i = 0; i < 400 && !window_->stats().refined; ++i) ASSERT_TRUE(window_->render(model_));
  EXPECT_TRUE(window_->stats().refined) << "what rests is drawn with all its pixels";
  const auto saved = window_->screenshot();
  ASSERT_TRUE(saved);
  EXPECT_EQ(saved->width, quick->width);
  EXPECT_GT(share_of(*saved, kMiddle, is_tooth), 0.1);
}

}  // namespace
}  // namespace enamel::view::test
