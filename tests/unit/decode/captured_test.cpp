// Captured fringes of other people's projectors and cameras, solved with the product's own steps. Skipped where absent.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/blocks_scene.hpp"
#include "tests/support/plaster_eye.hpp"
#include "tests/support/shared_data.hpp"

namespace enamel {
namespace {

const std::string kFringe = test::shared_folder() + "/data/fringe";

class PlasterEye : public testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    const std::string folder = kFringe + "/plaster_eye_12step_gray";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    static const Result<test::PlasterSet> kSet = test::load_plaster(folder);
    ASSERT_TRUE(kSet) << kSet.error().message();
    set_ = &*kSet;
    figures_ = test::measure_plaster(*set_, GetParam()).value();
  }
  const test::PlasterSet* set_ = nullptr;
  test::PlasterFigures figures_;
};

TEST_P(PlasterEye, phase_of_four_frames_is_that_of_twelve) {
  EXPECT_LE(figures_.full.repeating_rad, figures_.raw.repeating_rad / 6);
  // Targets, of which 0.030 are the noise of four frames.
  EXPECT_LE(figures_.full.rms_rad, 0.031);
  EXPECT_LE(figures_.full.repeating_rad, 0.005);
  EXPECT_GT(figures_.raw.repeating_rad, 0.02);  // the control: the ripple is there
}

TEST_P(PlasterEye, orders_are_those_of_the_gray_code) {
  EXPECT_GE(figures_.orders_equal, 0.998);
  EXPECT_GE(static_cast<double>(figures_.solved_px), 0.98 * static_cast<double>(figures_.reference_px));
  // Not by voting alone: nearly all pixels hang together in segments far larger than a fringe.
  EXPECT_GE(figures_.hanging_share, 0.9);
}

TEST_P(PlasterEye, depth_is_where_the_calibration_puts_the_relief) {
  EXPECT_GE(std::lround(figures_.near_mm), 750);  // whole mm, as the set's description states them
  EXPECT_LE(std::lround(figures_.far_mm), 846);
}

/// A consumer's projector that is not linear, and no code: nothing is wrong with such a burst but that nothing places
/// it, and it tells what hangs together.
TEST_P(PlasterEye, burst_without_a_code_is_told_by_its_regions) {
  calib::Rig rig = set_->rig;
  rig.depth_range = calib::DepthRange{700, 900};
  const auto decoder = pipeline::BurstDecoder::make(rig, {});
  ASSERT_TRUE(decoder) << decoder.error().message();
  const auto frames = test::burst_of(set_->images, GetParam(), 3);
  ASSERT_TRUE(frames);
  const auto burst = decoder->decode(frames->view());
  EXPECT_EQ(burst.verdict, pipeline::BurstVerdict::kNoCode) << name_of(burst.verdict);
  EXPECT_GE(burst.relative.phase_rad.size(), figures_.reference_px / 2);
}

INSTANTIATE_TEST_SUITE_P(EveryThirdFrame, PlasterEye, testing::Values(0U, 1U, 2U));

TEST(PlasterEyeControl, images_of_another_place_in_the_cycle_are_not_the_reference) {
  const std::string folder = kFringe + "/plaster_eye_12step_gray";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  test::PlasterSet set = test::load_plaster(folder).value();
  std::swap(set.images.images[3], set.images.images[6]);  // burst 0 with two frames exchanged
  const auto f = test::measure_plaster(set, 0).value();
  EXPECT_GT(f.full.rms_rad, 0.2);
}

TEST(Blocks, distorted_fringes_keep_together_and_follow_the_gray_cells) {
  const std::string folder = kFringe + "/blocks_3step_2freq_gray";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const auto f = test::measure_blocks(folder);
  ASSERT_TRUE(f) << f.error().message();
  RecordProperty("orders_equal", std::to_string(f->orders_equal));  // 0.80: no code, so a leak moves a whole block
  EXPECT_GE(static_cast<double>(f->solved_px), 0.95 * static_cast<double>(f->lit_px));
  EXPECT_LE(f->links_torn, 5e-4);  // of neighbours that unwrapping takes for one surface
  EXPECT_LE(f->ripple_after, f->ripple_before / 9);
  EXPECT_GT(f->ripple_before, 0.1);  // the control: these fringes are no sinusoids
}

TEST(FringeSet, says_what_is_wrong_with_a_folder) {
  EXPECT_EQ(test::load_fringe_images("/nowhere", {"00"}).error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(test::load_fringe_images(".", {}).error().code, ErrorCode::kEmptyInput);
  test::FringeImages three{1, 1, {{1}, {2}, {3}}};
  EXPECT_EQ(test::burst_of(three, 0, 1).error().code, ErrorCode::kBurstNotFound);
}

}  // namespace
}  // namespace enamel
