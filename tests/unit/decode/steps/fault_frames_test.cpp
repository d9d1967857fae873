// Bursts whose frames are not what they should be: duplicated, left over from the burst before, blinded. None may be
// decoded, and each must be counted under the right reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

/// In mode T and in mode M.
class FaultFrames : public testing::TestWithParam<bool> {
 protected:
  static const calib::Rig& rig() {
    static const calib::Rig kT = test::cropped_rig(320, 120), kM = test::micro_rig(320, 120);
    return GetParam() ? kM : kT;
  }
  static const BurstDecoder& decoder() {
    static const BurstDecoder kT = BurstDecoder::make(test::cropped_rig(320, 120)).value();
    static const BurstDecoder kM = BurstDecoder::make(test::micro_rig(320, 120)).value();
    return GetParam() ? kM : kT;
  }
  /// The frames that the phase rests on.
  static std::array<std::size_t, 3> phase_frames() {
    return GetParam() ? std::array<std::size_t, 3>{0, 2, 3} : std::array<std::size_t, 3>{0, 1, 2};
  }
  /// A tilted surface, `nearer_mm` nearer than the burst before.
  static test::FrameSet burst(double nearer_mm, std::uint64_t seed) {
    test::SceneOptions o;
    o.noise = true;
    o.seed = seed;
    return test::render(
               rig(), [=](int u, int v) { return 47 - nearer_mm + 0.008 * u + 0.004 * v; }, o)
        .frames;
  }
};

INSTANTIATE_TEST_SUITE_P(Modes, FaultFrames, testing::Bool(), [](const auto& mode) { return mode.param ? "M" : "T"; });

TEST_P(FaultFrames, whole_burst_is_accepted) {  // the control of all that follow
  EXPECT_EQ(decoder().decode(burst(0, 1).view()).verdict, BurstVerdict::kAccepted);
}

TEST_P(FaultFrames, any_frame_sent_twice_in_place_of_another_is_detected) {
  const test::FrameSet good = burst(0, 1);
  for (std::size_t lost = 0; lost < 4; ++lost) {
    for (std::size_t twice = 0; twice < 4; ++twice) {
      if (lost == twice) continue;
      test::FrameSet bad = good;
      bad.frames[lost] = good.frames[twice];
      const DecodedBurst b = decoder().decode(bad.view());
      EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch) << "frame " << twice << " in place of " << lost;
      EXPECT_EQ(b.patch.valid_px, 0U);
    }
  }
}

TEST_P(FaultFrames, frame_left_over_from_a_burst_a_third_of_a_fringe_away_is_detected) {
  const double away_mm = test::fringe_jump_mm(rig(), 48) / 3;
  const test::FrameSet now = burst(0, 1), before = burst(away_mm, 2);
  for (std::size_t stale = 0; stale < 4; ++stale) {
    test::FrameSet bad = now;
    bad.frames[stale] = before.frames[stale];
    const DecodedBurst b = decoder().decode(bad.view());
    EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch)
        << "frame " << stale << ": " << name_of(b.verdict) << " linked " << b.diagnostics.linked_share << " closure "
        << b.diagnostics.closure_share << " code " << b.diagnostics.code_agreement << " torn "
        << b.diagnostics.torn_share << " motion " << b.diagnostics.motion_rad;
  }
}

/// However little has moved since: the bytes tell.
TEST_P(FaultFrames, frame_left_over_from_a_burst_before_is_told_by_that_burst) {
  const test::FrameSet now = burst(0, 1), before = burst(0.02, 2), between = burst(0.01, 3);
  const std::array known{before.view(), between.view()};
  const auto verdict = [](const test::FrameSet& frames, std::span<const BurstView> bursts) {
    DecodeWorkspace workspace;
    DecodedBurst out;
    decoder().decode(frames.view(), workspace, out, {bursts, {}});
    return out.verdict;
  };
  std::size_t unseen = 0;
  for (std::size_t stale = 0; stale < 4; ++stale) {
    test::FrameSet bad = now;
    bad.frames[stale] = before.frames[stale];
    EXPECT_EQ(verdict(bad, known), BurstVerdict::kPatternMismatch) << stale;
    unseen += verdict(bad, {}) == BurstVerdict::kAccepted ? 1U : 0U;
  }
  EXPECT_GT(unseen, 0U) << "negative control: a single burst cannot tell so little";
  EXPECT_EQ(verdict(now, known), BurstVerdict::kAccepted);
  EXPECT_EQ(verdict(before, known), BurstVerdict::kAccepted) << "a burst sent again is whole";
}

TEST_P(FaultFrames, frame_without_a_picture_is_detected) {
  const test::FrameSet good = burst(0, 1);
  for (std::size_t blank = 0; blank < 4; ++blank) {
    for (const int level : {60, 110, 127, 200}) {
      test::FrameSet bad = good;
      bad.frames[blank].assign(bad.frames[blank].size(), static_cast<std::uint8_t>(level));
      EXPECT_EQ(decoder().decode(bad.view()).verdict, BurstVerdict::kPatternMismatch) << blank << " at " << level;
    }
  }
}

TEST(SmallFrames, of_fewer_pixels_than_a_burst_needs_are_not_called_dark) {
  const calib::Rig rig = test::cropped_rig(20, 20);
  const auto scene = test::render(rig, test::flat(48), test::noisy());
  EXPECT_EQ(BurstDecoder::make(rig).value().decode(scene.frames.view()).verdict, BurstVerdict::kTooFewPoints);
}

/// All of a column lies at one phase: no frame of it shows fringes, and none is blank for that.
TEST(SmallFrames, one_pixel_wide_are_not_called_wrong_frames) {
  const calib::Rig rig = test::cropped_rig(1, 480);
  DecodeConfig config;
  config.light.min_points = 100;
  const auto scene = test::render(rig, test::flat(48), test::noisy());
  const DecodedBurst b = BurstDecoder::make(rig, config).value().decode(scene.frames.view());
  EXPECT_EQ(b.verdict, BurstVerdict::kNoCode)
      << name_of(b.verdict) << " repeated " << b.diagnostics.repeated_share << " linked " << b.diagnostics.linked_share
      << " closure " << b.diagnostics.closure_share;
}

TEST_P(FaultFrames, two_or_more_blinded_frames_are_called_saturated) {
  const test::FrameSet good = burst(0, 1);
  for (unsigned blinded = 0; blinded < 16; ++blinded) {
    test::FrameSet bad = good;
    int count = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if ((blinded >> k & 1U) != 0) bad.frames[k].assign(bad.frames[k].size(), 255), ++count;
    if (count < 2) continue;
    EXPECT_EQ(decoder().decode(bad.view()).verdict, BurstVerdict::kSaturated) << blinded;
  }
}

TEST_P(FaultFrames, light_that_clips_the_crests_of_the_fringes_leaves_no_wrong_depth) {
  test::SceneOptions o;
  o.mean_dn = 190;
  o.modulation_dn = 150;  // crests at 340 of 255: two frames clipped at most pixels
  const auto scene = test::render(rig(), test::flat(48), o);
  const DecodedBurst b = decoder().decode(scene.frames.view());
  EXPECT_EQ(b.verdict, BurstVerdict::kSaturated) << name_of(b.verdict) << ' ' << b.patch.valid_px;
  for (std::size_t i = 0; i < b.reject.size(); ++i) {
    int clipped = 0;
    for (const std::size_t k : phase_frames()) clipped += scene.frames.frames[k][i] == 255 ? 1 : 0;
    if (clipped > 1) {
      ASSERT_EQ(b.reject[i], PixelReject::kSaturated) << i;
    }
  }
}

}  // namespace
}  // namespace enamel::pipeline
