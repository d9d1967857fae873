// Gates on whether orders and frames are those of the rig's code: region by region, by direction, by repetition.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "pipeline/decode/steps/decode_gates.hpp"
#include "pipeline/decode/steps/frame_gates.hpp"
#include "pipeline/decode/steps/fringe_orders.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kMinAgreement = 0.9;
constexpr int kSegment_px = 10;

/// Segments of 10 px that hang together at one shift, so many of each stance.
struct RegionOf {
  int component = 0, shift = 0;
  int agreeing = 0, contradicting = 0, silent = 0;
  bool decided = true;
};

FringeOrders orders_of(const std::vector<RegionOf>& regions) {
  FringeOrders out;
  const auto add = [&](const RegionOf& region, Stance code) {
    const auto row = static_cast<std::int32_t>(out.segments.segments.size());
    Segment segment;
    segment.row = row, segment.begin = 5, segment.end = 5 + kSegment_px, segment.component = region.component;
    out.segments.segments.push_back(segment);
    SegmentOrder order;
    order.shift = region.shift, order.decided = region.decided, order.code = code;
    out.orders.segments.push_back(order);
  };
  for (const RegionOf& region : regions) {
    for (int k = 0; k < region.agreeing; ++k) add(region, Stance::kAgrees);
    for (int k = 0; k < region.contradicting; ++k) add(region, Stance::kContradicts);
    for (int k = 0; k < region.silent; ++k) add(region, Stance::kSilent);
  }
  return out;
}

/// Decided segments of a region.
int decided_of(const FringeOrders& o, int component, int shift) {
  int n = 0;
  for (std::size_t k = 0; k < o.orders.segments.size(); ++k) {
    const SegmentOrder& order = o.orders.segments[k];
    n += o.segments.segments[k].component == component && order.shift == shift && order.decided ? 1 : 0;
  }
  return n;
}

TEST(WithdrawContradicted, region_whose_code_is_another_is_decided_no_more_and_the_others_stay) {
  FringeOrders o = orders_of({{0, 0, 20, 1, 4}, {1, 0, 3, 7, 2}, {2, 1, 30, 0, 0}});
  const double share = withdraw_contradicted(o, kMinAgreement);
  EXPECT_EQ(decided_of(o, 1, 0), 0) << "its silent segments with it";
  EXPECT_EQ(decided_of(o, 0, 0), 25);
  EXPECT_EQ(decided_of(o, 2, 1), 30);
  EXPECT_NEAR(share, 12.0 / 67, 1e-12);
}

TEST(WithdrawContradicted, region_is_what_hangs_together_at_one_shift) {
  FringeOrders o = orders_of({{0, 0, 40, 0, 0}, {0, 1, 2, 5, 0}});
  EXPECT_NEAR(withdraw_contradicted(o, kMinAgreement), 7.0 / 47, 1e-12);
  EXPECT_EQ(decided_of(o, 0, 0), 40);
  EXPECT_EQ(decided_of(o, 0, 1), 0);
}

TEST(WithdrawContradicted, fewer_than_three_lying_segments_are_a_glint) {
  FringeOrders two = orders_of({{0, 0, 1, 2, 3}}), three = orders_of({{0, 0, 1, 3, 3}});
  EXPECT_EQ(withdraw_contradicted(two, kMinAgreement), 0);
  EXPECT_EQ(decided_of(two, 0, 0), 6);
  EXPECT_EQ(withdraw_contradicted(three, kMinAgreement), 1) << "negative control";
  EXPECT_EQ(decided_of(three, 0, 0), 0);
}

TEST(WithdrawContradicted, region_that_just_agrees_stays) {
  FringeOrders o = orders_of({{0, 0, 36, 4, 0}}), less = orders_of({{0, 0, 35, 4, 0}});
  EXPECT_EQ(withdraw_contradicted(o, kMinAgreement), 0);
  EXPECT_EQ(withdraw_contradicted(less, kMinAgreement), 1) << "negative control: 35 of 39";
}

TEST(WithdrawContradicted, what_was_undecided_counts_in_no_share) {
  FringeOrders o = orders_of({{0, 0, 20, 0, 0}, {1, 0, 0, 5, 0}, {2, 0, 40, 40, 0, false}});
  EXPECT_NEAR(withdraw_contradicted(o, kMinAgreement), 5.0 / 25, 1e-12);
  FringeOrders none;
  EXPECT_EQ(withdraw_contradicted(none, kMinAgreement), 0);
}

constexpr int kWidth = 320, kHeight = 80;

/// Wrapped phase in noise over a carrier of so many px a fringe; turned: of frames in the wrong order.
double share_of(double sigma_rad, bool turned, double fringe_px = 26, double carrier_px = 26) {
  PhaseMaps maps;
  maps.resize(kWidth, kHeight);
  std::vector<float> carrier_rad;
  test::Normals normal(3);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const int u = i % kWidth, v = i / kWidth;
    const double phase = 2 * std::numbers::pi * (u / fringe_px + 0.07 * v);
    carrier_rad.push_back(static_cast<float>(2 * std::numbers::pi * u / carrier_px));
    const auto at = static_cast<std::size_t>(i);
    maps.phase_rad[at] =
        static_cast<float>(std::remainder((turned ? -phase : phase) + sigma_rad * normal(), 2 * std::numbers::pi));
    maps.sigma_rad[at] = static_cast<float>(sigma_rad);
    maps.reject[at] = PixelReject::kNone;
  }
  return direction_share(maps, {carrier_rad.data(), 0, 0});
}

TEST(DirectionShare, is_one_of_right_frames_and_none_of_turned_ones_whatever_the_noise) {
  const double limit_rad = static_cast<double>(PhaseConfig{}.max_sigma_rad);
  for (const double sigma_rad : {1e-3, 0.05, 0.1, limit_rad}) {
    EXPECT_GT(share_of(sigma_rad, false), 0.98) << sigma_rad;
    EXPECT_LT(share_of(sigma_rad, true), 0.02) << sigma_rad;
  }
}

TEST(DirectionShare, of_a_slanted_surface_is_that_of_a_plane) {
  const double limit_rad = static_cast<double>(PhaseConfig{}.max_sigma_rad);
  for (const double fringe_px : {18.0, 34.0}) {
    EXPECT_GT(share_of(limit_rad, false, fringe_px), 0.85) << fringe_px;
    EXPECT_LT(share_of(limit_rad, true, fringe_px), 0.15) << fringe_px;
  }
}

TEST(DirectionShare, of_a_narrow_field_asks_pixels_so_far_apart_that_noise_leaves_the_sign) {
  const double limit_rad = static_cast<double>(PhaseConfig{}.max_sigma_rad);
  for (const double fringe_px : {60.0, 140.0, 260.0}) {  // facing away, as the carrier, and towards
    EXPECT_GT(share_of(limit_rad, false, fringe_px, 140), 0.85) << fringe_px;
    EXPECT_LT(share_of(limit_rad, true, fringe_px, 140), 0.15) << fringe_px;
  }
}

TEST(DirectionShare, of_no_valid_pixel_is_none) {
  PhaseMaps maps;
  maps.resize(8, 8);
  std::ranges::fill(maps.reject.pixels(), PixelReject::kDark);
  const std::vector<float> carrier_rad(64, 0.0F);
  EXPECT_EQ(direction_share(maps, {carrier_rad.data(), 0, 0}), 0);
}

/// A burst of either mode; again: the frame that shows the picture of frame 0 once more, by an exposure of its own.
double repeated_of(bool micro, double modulation_dn, std::size_t again = 0) {
  const calib::Rig rig = micro ? test::micro_rig(kWidth, kHeight) : test::cropped_rig(kWidth, kHeight);
  test::SceneOptions o = test::with_noise();
  o.modulation_dn = modulation_dn;
  test::FrameSet set = test::render(rig, test::flat(48), o).frames;
  if (again > 0) {
    o.seed = 2;
    set.frames[again] = test::render(rig, test::flat(48), o).frames.frames[0];
  }
  const NoiseModel noise = noise_from_rig(*rig.noise, 8);
  PhaseMaps maps;
  if (micro) {
    compute_micro_phase(set.view(), noise, {}, maps);
  } else {
    compute_phase(set.view(), noise, {}, maps);
  }
  // All lit pixels, of which the mask takes some at its limit.
  std::ranges::replace(maps.reject.pixels(), PixelReject::kNoisy, PixelReject::kNone);
  return repeated_share(set.view(), maps, noise);
}

/// At which three frames of mean_dn have the phase noise where the mask ends: sigma = sqrt(2/3) sigma_n/B.
double faintest_modulation_dn() {
  const calib::NoiseValues sensor = *test::cropped_rig(8, 8).noise;
  const double e = test::SceneOptions{}.mean_dn * sensor.gain_e_per_dn + sensor.read_noise_e * sensor.read_noise_e;
  const double sigma_dn = std::sqrt(e / (sensor.gain_e_per_dn * sensor.gain_e_per_dn) + 1.0 / 12);
  return std::sqrt(2.0 / 3) * sigma_dn / static_cast<double>(PhaseConfig{}.max_sigma_rad);
}

TEST(RepeatedShare, of_two_exposures_of_one_picture_is_one) {
  for (const double modulation_dn : {faintest_modulation_dn(), 80.0}) {
    EXPECT_NEAR(repeated_of(true, modulation_dn, 1), 1, 0.02) << modulation_dn;
    EXPECT_NEAR(repeated_of(true, modulation_dn, 2), 1, 0.02) << modulation_dn;
    EXPECT_NEAR(repeated_of(false, modulation_dn, 1), 1, 0.02) << modulation_dn;
  }
}

TEST(RepeatedShare, of_fringes_is_little_even_where_noise_ends_the_mask) {
  for (const double modulation_dn : {faintest_modulation_dn(), 2 * faintest_modulation_dn(), 80.0}) {
    EXPECT_LT(repeated_of(true, modulation_dn), 0.5) << modulation_dn;
    EXPECT_LT(repeated_of(false, modulation_dn), 0.9) << modulation_dn << ": frame 3 repeats frame 1 in half the cells";
  }
}

TEST(RepeatedShare, of_light_without_fringes_is_one) { EXPECT_GT(repeated_of(true, 0), 0.95) << "negative control"; }

bool refused(float odd_shift_rad, std::optional<double> odd_share, double code_agreement = 1) {
  DecodeDiagnostics d;
  d.odd_shift_rad = odd_shift_rad, d.odd_share = odd_share, d.code_agreement = code_agreement;
  return has_odd_frame(d, {});
}

TEST(OddFrame, is_refused_where_it_is_what_the_frames_differ_by_and_not_where_much_else_is) {
  EXPECT_TRUE(refused(0.2F, 0.8));
  EXPECT_FALSE(refused(0.2F, 0.2));
  EXPECT_TRUE(refused(0.2F, 0.2, 0.92)) << "no excuse for a code that is not sound";
  EXPECT_TRUE(refused(0.2F, std::nullopt, 0.92)) << "of a mode that does not tell";
}

TEST(OddFrame, is_not_excused_by_light_that_would_change_more_than_the_fringes) {
  DecodeDiagnostics d;
  d.odd_shift_rad = 0.3F, d.unrest = 0.5F;
  EXPECT_FALSE(has_odd_frame(d, {}));
  d.unrest = 7;
  EXPECT_TRUE(has_odd_frame(d, {}));
}

TEST(WaveShape, of_projectors_has_little_third_harmonic) {
  DecodeDiagnostics d;
  d.wave.harmonic = {0.3, -0.06, 0.01, 0};
  EXPECT_TRUE(could_be_projected(d, {}));
  d.wave.harmonic[1] = -0.29;
  EXPECT_FALSE(could_be_projected(d, {}));
}

TEST(OddFrame, needs_less_of_a_shift_where_it_explains_most) {
  EXPECT_FALSE(refused(0.08F, 0.4));
  EXPECT_TRUE(refused(0.08F, 0.8));
}

}  // namespace
}  // namespace enamel::pipeline
