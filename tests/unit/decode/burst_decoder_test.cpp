#include "pipeline/decode/burst_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "protocol/base/crc32.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

const calib::Rig& small_rig() {
  static const calib::Rig kRig = test::cropped_rig(320, 120);
  return kRig;
}

const BurstDecoder& small_decoder() {
  static const BurstDecoder kDecoder = BurstDecoder::make(small_rig()).value();
  return kDecoder;
}

using test::noisy;

struct ErrorSums {
  double n = 0, sum = 0, squares = 0, normalised = 0;
  void add(double e_mm, double sigma_mm) {
    n += 1, sum += e_mm, squares += e_mm * e_mm, normalised += (e_mm / sigma_mm) * (e_mm / sigma_mm);
  }
  [[nodiscard]] double mean_um() const { return 1e3 * sum / n; }
  [[nodiscard]] double rms_um() const { return 1e3 * std::sqrt(squares / n); }
};

ErrorSums errors_of(const DecodedBurst& b, const test::SyntheticBurst& truth) {
  ErrorSums s;
  for (std::size_t i = 0; i < b.patch.depth_mm.size(); ++i) {
    if (!std::isnan(b.patch.depth_mm[i]))
      s.add(static_cast<double>(b.patch.depth_mm[i]) - truth.depth_mm[i], static_cast<double>(b.patch.sigma_mm[i]));
  }
  return s;
}

TEST(BurstDecoder, predicted_sigma_matches_the_scatter_at_every_modulation) {
  for (const double modulation : {5.0, 10.0, 20.0, 50.0, 100.0}) {
    const auto scene = test::render(small_rig(), test::flat(48), noisy(modulation));
    const DecodedBurst b = small_decoder().decode(scene.frames.view());
    ASSERT_TRUE(b.accepted()) << modulation;
    const ErrorSums e = errors_of(b, scene);
    ASSERT_GT(e.n, 0.8 * 320 * 120) << modulation;
    EXPECT_NEAR(std::sqrt(e.normalised / e.n), 1.0, 0.05) << modulation;
  }
}

TEST(BurstDecoder, every_permutation_of_the_frames_is_detected) {
  const auto scene = test::render(
      small_rig(), [](int u, int v) { return 46 + 0.008 * u + 0.004 * v; }, noisy());
  std::array<std::size_t, 4> order = {0, 1, 2, 3};
  EXPECT_TRUE(small_decoder().decode(scene.frames.view()).accepted());  // the control: in order it is accepted
  int permutations = 0;
  while (std::next_permutation(order.begin(), order.end())) {
    BurstView view = scene.frames.view();
    for (std::size_t k = 0; k < 4; ++k) view.frames[k] = scene.frames.frames[order[k]];
    const DecodedBurst b = small_decoder().decode(view);
    EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch)
        << order[0] << order[1] << order[2] << order[3] << " linked " << b.diagnostics.linked_share << " closure "
        << b.diagnostics.closure_share << " code " << b.diagnostics.code_agreement << " valid " << b.patch.valid_px;
    ++permutations;
  }
  EXPECT_EQ(permutations, 23);
}

TEST(BurstDecoder, foreign_polarity_code_is_refused) {
  calib::Rig other = small_rig();
  other.patterns.polarity_code = {1, -1, -1, 1, 1, 1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1};
  const auto scene = test::render(other, test::flat(48), noisy());
  const DecodedBurst b = small_decoder().decode(scene.frames.view());
  EXPECT_EQ(b.verdict, BurstVerdict::kPatternMismatch) << "code " << b.diagnostics.code_agreement << " torn "
                                                       << b.diagnostics.torn_share << " valid " << b.patch.valid_px;
}

TEST(BurstDecoder, names_why_a_burst_is_rejected) {
  test::FrameSet f{320, 120, {}};
  for (auto& frame : f.frames) frame.assign(320 * 120, 4);
  EXPECT_EQ(small_decoder().decode(f.view()).verdict, BurstVerdict::kTooDark);
  for (auto& frame : f.frames) frame.assign(320 * 120, 255);
  EXPECT_EQ(small_decoder().decode(f.view()).verdict, BurstVerdict::kSaturated);
  f.width = 120, f.height = 320;
  EXPECT_EQ(small_decoder().decode(f.view()).verdict, BurstVerdict::kFrameMismatch);
  EXPECT_EQ(small_decoder().decode(BurstView{}).verdict, BurstVerdict::kFrameMismatch);
}

TEST(BurstDecoder, every_pixel_has_depth_or_exactly_one_reason) {
  test::SceneOptions o = noisy();
  o.light = [](int u, int) { return u < 240 ? 1.0 : 0.0; };
  const auto scene = test::render(
      small_rig(), [](int u, int) { return u < 120 ? 45.0 : 49.0; }, o);
  const DecodedBurst b = small_decoder().decode(scene.frames.view());
  std::size_t sum = 0;
  for (const std::size_t n : b.counts) sum += n;
  EXPECT_EQ(sum, 320U * 120U);
  EXPECT_EQ(b.counts[0], b.patch.valid_px);
  for (std::size_t i = 0; i < b.reject.size(); ++i) {
    const bool has = !std::isnan(b.patch.depth_mm[i]);
    ASSERT_EQ(has, b.reject[i] == PixelReject::kNone);
    ASSERT_EQ(has, !std::isnan(b.patch.sigma_mm[i]));
    ASSERT_EQ(has, b.order[i] != kNoOrder);
    ASSERT_EQ(has, b.patch.points[i].allFinite());
  }
}

TEST(BurstDecoder, phase_and_order_maps_give_the_projector_column) {
  const auto scene = test::render(
      small_rig(), [](int u, int) { return 44 + 0.01 * u; }, noisy());
  const DecodedBurst b = small_decoder().decode(scene.frames.view());
  ASSERT_TRUE(b.accepted());
  for (std::size_t i = 0; i < b.order.size(); ++i) {
    if (b.order[i] == kNoOrder) continue;
    const auto phi = static_cast<double>(b.phase_rad[i]);
    ASSERT_GE(phi, -3.1415927410125732);
    ASSERT_LT(phi, 3.1415927410125732);
    const double fringes = b.order[i] + phi / (2 * std::numbers::pi) + (phi < 0 ? 1 : 0);
    ASSERT_NEAR(fringes * 2 * std::numbers::pi, scene.phase_rad[i], 0.2);
  }
}

TEST(BurstDecoder, motion_within_the_burst_leaves_no_ripple_and_no_steps_at_flips) {
  test::SceneOptions o;
  o.motion_rad = 0.1;  // 56 um a frame
  const auto scene = test::render(small_rig(), test::flat(48), o);
  const DecodedBurst corrected = small_decoder().decode(scene.frames.view());
  ASSERT_TRUE(corrected.accepted());
  EXPECT_NEAR(corrected.diagnostics.motion_rad, 0.1, 0.01);  // the model is first order: relative error of order eps
  EXPECT_LT(errors_of(corrected, scene).rms_um(), 4.0);
  DecodeConfig raw;
  raw.correct_closure = raw.correct_ripple = false;
  const DecodedBurst plain = BurstDecoder::make(small_rig(), raw).value().decode(scene.frames.view());
  EXPECT_GT(errors_of(plain, scene).rms_um(), 15.0);  // the control: without correction the ripple is there
}

TEST(BurstDecoder, second_harmonic_does_not_print_the_code_on_the_surface) {
  test::SceneOptions o;
  o.harmonic = 0.02;
  const auto scene = test::render(small_rig(), test::flat(48), o);
  const DecodedBurst b = small_decoder().decode(scene.frames.view());
  const CellSigns signs = make_cell_signs(small_rig().patterns, small_rig().projector).value();
  ErrorSums plus, minus;
  for (std::size_t i = 0; i < b.patch.depth_mm.size(); ++i) {
    if (std::isnan(b.patch.depth_mm[i])) continue;
    const int cell = static_cast<int>(std::floor(scene.phase_rad[i] / std::numbers::pi));
    (signs.at(cell) > 0 ? plus : minus).add(static_cast<double>(b.patch.depth_mm[i]) - scene.depth_mm[i], 1);
  }
  EXPECT_NEAR(b.diagnostics.harmonic, 0.02, 0.001);
  EXPECT_LT(std::abs(plus.mean_um() - minus.mean_um()), 0.5);
}

TEST(BurstDecoder, reused_workspace_gives_the_bits_of_a_fresh_one) {
  const auto a = test::render(small_rig(), test::flat(44), noisy());
  const auto b = test::render(
      small_rig(), [](int u, int) { return u < 150 ? 45.0 : 51.0; }, noisy());
  DecodeWorkspace workspace;
  DecodedBurst reused;
  small_decoder().decode(a.frames.view(), workspace, reused);
  small_decoder().decode(b.frames.view(), workspace, reused);
  const DecodedBurst fresh = small_decoder().decode(b.frames.view());
  const auto crc = [](const Map<float>& m) { return enamel::crc32(std::as_bytes(m.pixels())); };
  EXPECT_EQ(crc(reused.patch.depth_mm), crc(fresh.patch.depth_mm));
  EXPECT_EQ(crc(reused.phase_rad), crc(fresh.phase_rad));
  EXPECT_EQ(reused.counts, fresh.counts);
}

TEST(BurstDecoder, too_few_points_show_nothing_of_the_burst_before) {
  const auto before = test::render(small_rig(), test::flat(44), noisy());
  const auto now = test::render(small_rig(), test::flat(48), noisy());
  DecodeConfig config;
  config.light.min_points = now.depth_mm.size() + 1;
  const BurstDecoder demanding = BurstDecoder::make(small_rig(), config).value();
  DecodeWorkspace workspace;
  DecodedBurst reused;
  small_decoder().decode(before.frames.view(), workspace, reused);
  ASSERT_TRUE(reused.accepted());
  demanding.decode(now.frames.view(), workspace, reused);
  const DecodedBurst fresh = demanding.decode(now.frames.view());
  ASSERT_EQ(fresh.verdict, BurstVerdict::kTooFewPoints);
  EXPECT_EQ(enamel::crc32(std::as_bytes(reused.phase_rad.pixels())),
            enamel::crc32(std::as_bytes(fresh.phase_rad.pixels())));
  EXPECT_EQ(enamel::crc32(std::as_bytes(reused.reject.pixels())), enamel::crc32(std::as_bytes(fresh.reject.pixels())));
  EXPECT_EQ(reused.counts, fresh.counts);
}

TEST(BurstDecoder, needs_a_depth_range_from_somewhere) {
  calib::Rig rig = test::cropped_rig(64, 32);
  rig.depth_range.reset();
  EXPECT_EQ(BurstDecoder::make(rig).error().code, ErrorCode::kRigInvalid);
  DecodeConfig config;
  config.depth_range_mm = calib::DepthRange{40, 56};
  EXPECT_TRUE(BurstDecoder::make(rig, config));
}

TEST(BurstDecoder, decodes_without_sensor_values_and_says_so) {
  calib::Rig rig = small_rig();
  const auto scene = test::render(rig, test::flat(48), noisy());
  rig.noise.reset();
  const DecodedBurst b = BurstDecoder::make(rig).value().decode(scene.frames.view());
  ASSERT_TRUE(b.accepted());
  EXPECT_EQ(b.diagnostics.noise.source, NoiseSource::kClosure);
  EXPECT_GT(b.patch.valid_px, 300U * 120U);
}

}  // namespace
}  // namespace enamel::pipeline
