// The same picture without any display.
#include "viewer/gl/offscreen.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/unit/viewer/picture_probe.hpp"
#include "tests/unit/viewer/tooth_scene.hpp"
#include "viewer/scene/keys.hpp"

namespace enamel::view::test {
namespace {

class OffscreenTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto probe = draw_offscreen(PreviewFrame{}, options_);
    if (!probe) {
      GTEST_SKIP() << probe.error().message();
    }
  }
  Picture draw(const PreviewFrame& frame) {
    auto picture = draw_offscreen(frame, options_);
    EXPECT_TRUE(picture) << picture.error().message();
    return picture ? std::move(*picture) : Picture{};
  }
  ViewerOptions options_;
  ToothScene scene_;
};

TEST_F(OffscreenTest, shows_model_field_live_image_and_outline) {
  auto frame = scene_.frame(12, 20);
  frame->live = std::make_shared<Map<std::uint8_t>>(320, 240, std::uint8_t{180});
  const Picture picture = draw(*frame);
  EXPECT_EQ(picture.drawn_by.rfind("EGL surfaceless", 0), 0U) << picture.drawn_by;
  EXPECT_EQ(picture.width, options_.width);
  EXPECT_EQ(picture.height, options_.height);
  EXPECT_GT(share_of(picture, kMiddle, is_tooth), 0.10);
  EXPECT_GT(share_of(picture, kMiddle, is_green), 0.003);
  EXPECT_NEAR(mean_level(picture, kLiveCorner), 180, 12);
  EXPECT_LT(outline_distance(picture, kGood), 60);
}

TEST_F(OffscreenTest, glare_is_ringed_where_it_is_in_the_live_image) {
  auto frame = scene_.frame(12, 20);
  frame->live = std::make_shared<Map<std::uint8_t>>(320, 240, std::uint8_t{60});
  const auto is_amber = [](const Rgb& c) { return c[0] > 150 && c[0] > c[2] + 70; };
  const Region left{0.035, 0.69, 0.12, 0.91}, right{0.14, 0.69, 0.22, 0.91};
  EXPECT_EQ(share_of(draw(*frame), kLiveCorner, is_amber), 0.0) << "control";
  frame->sight = {.trouble = SightTrouble::kGlare, .x_px = 70, .y_px = 120};
  const Picture ringed = draw(*frame);
  EXPECT_GT(share_of(ringed, left, is_amber), 0.005);
  EXPECT_EQ(share_of(ringed, right, is_amber), 0.0);
}

TEST_F(OffscreenTest, without_model_and_field_the_middle_is_empty) {
  auto frame = scene_.frame(12, 20);
  frame->model = nullptr;
  options_.toggles.frustum = false;
  options_.toggles.trail = false;
  const Picture picture = draw(*frame);
  EXPECT_EQ(share_of(picture, kMiddle, is_tooth), 0.0);
  EXPECT_EQ(share_of(picture, kMiddle, is_green), 0.0);
}

TEST_F(OffscreenTest, quality_map_colours_the_model_other_than_teeth) {
  const auto frame = scene_.frame(12, 20);
  const double plain = share_of(draw(*frame), kMiddle, is_tooth);
  options_.toggles.quality_map = true;
  const auto is_blue = [](const Rgb& c) { return c[2] > 110 && c[2] > c[0] + 20; };
  const Picture mapped = draw(*frame);
  EXPECT_LT(share_of(mapped, kMiddle, is_tooth), 0.8 * plain);
  EXPECT_GT(share_of(mapped, kMiddle, is_blue), 0.01);
}

TEST_F(OffscreenTest, soft_tissue_is_striped_in_its_own_shade_and_hidden_by_its_key) {
  auto frame = scene_.frame(12, 20);
  const Picture teeth = draw(*frame);
  EXPECT_LT(share_of(teeth, kMiddle, is_gum), 0.002) << "control";
  frame->model = half_soft(*frame->model);
  const Picture shown = draw(*frame);
  const double soft = share_of(shown, kMiddle, is_gum);
  EXPECT_GT(soft, 0.03);
  ASSERT_TRUE(apply_toggle(Action::kSoftTissue, options_.toggles));
  const Picture hidden = draw(*frame);
  EXPECT_LT(share_of(hidden, kMiddle, is_gum), 0.1 * soft);
  EXPECT_GT(share_of(hidden, kMiddle, is_tooth), 0.03) << "teeth stay";
  // Words, not colour alone: the panel is there with the class only, and says something else when it is hidden.
  const Region words{0.82, 0.86, 0.985, 0.985};
  const auto differ = [&](const Picture& a, const Picture& b) {
    std::size_t at = 0, count = 0;
    share_of(a, words, [&](const Rgb&) { return ++at, false; });
    for (int y = static_cast<int>(words.y0 * a.height); y < static_cast<int>(words.y1 * a.height); ++y)
      for (int x = static_cast<int>(words.x0 * a.width); x < static_cast<int>(words.x1 * a.width); ++x)
        count += pixel(a, x, y) != pixel(b, x, y) ? 1U : 0U;
    return static_cast<double>(count) / static_cast<double>(at);
  };
  EXPECT_GT(differ(teeth, shown), 0.02);
  EXPECT_GT(differ(shown, hidden), 0.001);
}

TEST_F(OffscreenTest, finished_scan_shows_the_whole_model) {
  auto frame = scene_.frame(19, 20);
  options_.toggles.frustum = false;
  frame->state = ScanState::kFinished;
  const Picture picture = draw(*frame);
  EXPECT_GT(share_of(picture, {0.20, 0.15, 0.45, 0.65}, is_tooth), 0.15);  // first teeth
  EXPECT_GT(share_of(picture, {0.55, 0.15, 0.80, 0.65}, is_tooth), 0.15);  // last teeth
  EXPECT_EQ(share_of(picture, {0.01, 0.15, 0.06, 0.60}, is_tooth), 0.0);   // nothing cut off at the sides
  EXPECT_EQ(share_of(picture, {0.94, 0.40, 0.99, 0.95}, is_tooth), 0.0);
}

TEST_F(OffscreenTest, simulated_is_written_on_the_picture) {
  auto frame = scene_.frame(2, 20);
  const auto is_badge = [](const Rgb& c) { return c[0] > 220 && c[1] > 150 && c[1] < 200 && c[2] < 90; };
  const Region top_left{0.05, 0.01, 0.20, 0.08};
  EXPECT_GT(share_of(draw(*frame), top_left, is_badge), 0.05);
  frame->simulated = false;
  EXPECT_EQ(share_of(draw(*frame), top_left, is_badge), 0.0);
}

TEST_F(OffscreenTest, stages_are_shown_while_a_pipeline_runs_and_can_be_switched_off) {
  auto frame = scene_.frame(12, 20);
  const auto differ = [&](const PreviewFrame& shown) {
    options_.toggles.stages = true;
    const Picture with = draw(shown);
    options_.toggles.stages = false;
    const Picture without = draw(shown);
    std::size_t pixels = 0;
    for (std::size_t i = 0; i < with.rgb.size(); i += 3) pixels += with.rgb[i] != without.rgb[i] ? 1U : 0U;
    return static_cast<double>(pixels) / (static_cast<double>(with.rgb.size()) / 3);
  };
  EXPECT_EQ(differ(*frame), 0.0) << "nothing to show";
  auto figures = std::make_shared<PipelineFigures>();
  figures->bottleneck = "track: busy 95 % of the time, its input is full";
  for (const char* name : {"decode0", "decode1", "track", "fuse"})
    figures->stages.push_back({.name = name, .median_ms = 40, .p95_ms = 80, .busy = 0.5, .waits_for = "a worker"});
  frame->pipeline = figures;
  EXPECT_GT(differ(*frame), 0.02);
}

TEST_F(OffscreenTest, malformed_block_and_nan_pose_do_not_break_the_picture) {
  auto frame = scene_.frame(6, 20);
  auto model = std::make_shared<ModelSnapshot>(*frame->model);
  auto bad = std::make_shared<BlockMesh>(*model->blocks.front());
  bad->triangles.push_back({0, 1, 1'000'000});
  model->blocks.front() = bad;
  model->blocks.push_back(nullptr);
  frame->model = model;
  EXPECT_GT(share_of(draw(*frame), kMiddle, is_tooth), 0.03);
  frame->T_model_cam.matrix().setConstant(std::nan(""));
  EXPECT_EQ(draw(*frame).width, options_.width);
}

TEST_F(OffscreenTest, size_out_of_range_is_refused) {
  options_.width = 100'000;
  const auto picture = draw_offscreen(PreviewFrame{}, options_);
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace enamel::view::test
