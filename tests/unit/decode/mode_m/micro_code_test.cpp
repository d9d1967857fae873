// Mode M's code: which rigs are refused, and how often a patch of pixels gets a wrong order (figures of
// docs/notes/design-figures.md §2.3 made anew).
#include "pipeline/decode/mode_m/micro_code.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/decode/mode_m/micro_evidence.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(MicroCode, turns_by_one_step_an_order) {
  const calib::Rig rig = test::micro_rig(8, 8);
  const MicroCode code = make_micro_code(rig.patterns, rig.projector).value();
  EXPECT_EQ(code.cells, 2 * 854 / 24 + 2);
  ASSERT_GE(code.cosine.size(), 854U / 24 + 1);
  for (std::size_t k = 0; k < code.cosine.size(); ++k) {
    EXPECT_NEAR(code.cosine[k], std::cos(2 * kPi * static_cast<double>(k) / 6), 1e-6);
    EXPECT_NEAR(code.sine[k], std::sin(2 * kPi * static_cast<double>(k) / 6), 1e-6);
  }
}

TEST(MicroCode, refuses_what_it_cannot_decode) {
  calib::Rig rig = test::micro_rig(8, 8);
  rig.patterns.axis_v = true;
  EXPECT_EQ(make_micro_code(rig.patterns, rig.projector).error().code, ErrorCode::kPatternSet);
  rig = test::micro_rig(8, 8, 1.5);
  EXPECT_EQ(make_micro_code(rig.patterns, rig.projector).error().code, ErrorCode::kPatternSet);
  EXPECT_EQ(make_micro_code(test::cropped_rig(8, 8).patterns, rig.projector).error().code, ErrorCode::kPatternSet);
}

TEST(MicroCode, orders_of_the_depth_range_must_differ) {
  EXPECT_TRUE(check_orders_differ(6, 4.86));   // five orders
  EXPECT_TRUE(check_orders_differ(6, 5.9));    // six
  EXPECT_TRUE(check_orders_differ(12, 4.86));  // fragile, but 30 degrees apart
  const auto repeats = check_orders_differ(6, 6.1);
  ASSERT_FALSE(repeats);
  EXPECT_EQ(repeats.error().code, ErrorCode::kPatternAmbiguous);
  EXPECT_THAT(repeats.error().detail, testing::HasSubstr("code_ratio 6 repeats within the 7 fringe orders"));
  const auto alike = check_orders_differ(30, 4.86);
  ASSERT_FALSE(alike);
  EXPECT_EQ(alike.error().code, ErrorCode::kPatternAmbiguous);
  EXPECT_FALSE(check_orders_differ(2.5, 2.5));  // three orders on a circle of two and a half
}

TEST(MicroCode, decoder_checks_the_rig_at_load) {
  EXPECT_TRUE(BurstDecoder::make(test::micro_rig(64, 32)));
  const auto coarse = BurstDecoder::make(test::micro_rig(64, 32, 3));
  ASSERT_FALSE(coarse);
  EXPECT_EQ(coarse.error().code, ErrorCode::kPatternAmbiguous);
  calib::Rig rig = test::micro_rig(64, 32);
  rig.noise.reset();
  EXPECT_EQ(BurstDecoder::make(rig).error().code, ErrorCode::kRigInvalid);
}

/// How a burst was taken: which pattern, and when, in frame intervals from mid-burst.
struct Taken {
  double ratio = 6;
  std::array<double, 4> at = {-1.5, -0.5, 0.5, 1.5};  ///< phase frame 0, code frame, phase frames 1 and 2
};
constexpr Taken kInSecondSlot{};
constexpr Taken kLastOfEight{8, {-1.5, 1.5, -0.5, 0.5}};

/// Patches of n x n pixels, 27 px a fringe, five candidate orders, disturbed as in the design's figures: motion of 0.1
/// rad a frame, B2 of 1 %, a Gaussian blur of 0.1 fringe; noise in units of the modulation after blur.
class Patches {
 public:
  Patches(int n, double noise_share, const Taken& taken = kInSecondSlot)
      : n_(n), noise_share_(noise_share), taken_(taken), rig_(test::micro_rig(8, 8, taken.ratio)) {
    noise_.floor_dn2 = static_cast<float>(std::pow(kModulation * noise_share, 2));
    noise_.full_scale_dn = 65535;
  }

  struct Errors {
    double matched_pct = 0;   ///< wrong by the amplitude-free matched score, written out here
    double evidence_pct = 0;  ///< by the decoder's cost
  };

  Errors count(int patches) {
    Errors out;
    for (int p = 0; p < patches; ++p) {
      const int candidate = p % 5;
      const double start = 2 * kPi * (candidate + 10 + std::fmod(p * 0.6180339887, 1.0)) - kPi;  // phi evenly spread
      see(start);
      // Order of the first pixel as it was measured: noise may have carried it over the wrap.
      const int truth = static_cast<int>(std::lround((start - static_cast<double>(maps_.phase_rad[0])) / (2 * kPi)));
      out.matched_pct += best_matched(truth - candidate) != truth ? 100.0 / patches : 0;
      out.evidence_pct += best_evidence(truth - candidate) != truth ? 100.0 / patches : 0;
    }
    return out;
  }

 private:
  static constexpr double kMean = 30000, kModulation = 20000;  // of 16 bit

  void see(double start) {
    std::array<std::vector<std::uint8_t>, 4> bytes;
    const double code_to_fringe = std::pow(1 + 1 / taken_.ratio, 2);
    for (int i = 0; i < n_ * n_; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double phi = start + 2 * kPi / 27 * (i % n_) + 0.1 * taken_.at[k];
        const double gain = k == 1 ? std::exp(-2 * kPi * kPi * 0.01 * (code_to_fringe - 1)) : 1;
        const double seen = gain * test::frame_wave(rig_.patterns, static_cast<int>(k), phi, 0.01);
        const double dn = kMean + kModulation * (seen + noise_share_ * normal_());
        const auto value = static_cast<std::uint16_t>(std::clamp(std::lround(dn), 0L, 65535L));
        bytes[k].push_back(static_cast<std::uint8_t>(value & 255U));
        bytes[k].push_back(static_cast<std::uint8_t>(value >> 8U));
      }
    }
    BurstView view{n_, n_, 16, {}};
    for (std::size_t k = 0; k < 4; ++k) view.frames[k] = bytes[k];
    compute_micro_phase(view, noise_, {}, maps_);
  }

  /// Turn relative to the first pixel, as a flood would find it: the patch spans far less than a fringe.
  [[nodiscard]] int turn_within(std::size_t i) const {
    const auto step = static_cast<double>(maps_.phase_rad[i] - maps_.phase_rad[0]);
    return step < -kPi ? 1 : (step > kPi ? -1 : 0);
  }

  [[nodiscard]] int best_matched(int lowest) const {
    int best = -1;
    double most = -1e9;
    for (int k = lowest; k < lowest + 5; ++k) {
      double dot = 0, energy = 0;
      for (std::size_t i = 0; i < maps_.phase_rad.size(); ++i) {
        const double phi = static_cast<double>(maps_.phase_rad[i]) + 2 * kPi * (k + turn_within(i));
        const double c = std::cos(phi * (1 + 1 / taken_.ratio)), b = static_cast<double>(maps_.modulation_dn[i]);
        dot += static_cast<double>(maps_.code_dn[i]) * b * c;
        energy += b * b * c * c;
      }
      const double score = dot / std::sqrt(energy);
      if (score > most) most = score, best = k;
    }
    return best;
  }

  [[nodiscard]] int best_evidence(int lowest) const {
    const MicroCode code = make_micro_code(rig_.patterns, rig_.projector).value();
    CodeSumRow row, sums;  // sums: by turn within the patch; the decoder's segments end at a wrap
    sums.resize(3);
    for (std::size_t i = 0; i < maps_.phase_rad.size(); ++i) {
      const auto n = static_cast<std::size_t>(n_);
      if (i % n == 0) code_sums_of_row(maps_, noise_, code, i / n, row);
      const auto turn = static_cast<std::size_t>(turn_within(i) + 1);
      sums.put(turn, sums.at(turn) + row.at(i % n));
    }
    CodePhasors said;
    find_phasors(sums, 4.6F, said);
    int best = -1;
    float least = 1e9F;
    for (int k = lowest; k < lowest + 5; ++k) {
      float cost = 0;
      for (std::size_t turn = 0; turn < 3; ++turn) {
        const std::size_t order = static_cast<std::size_t>(k) + turn - 1;
        cost += cost_of_turn(said.at(turn), code.cosine[order], code.sine[order]);
      }
      if (cost < least) least = cost, best = k;
    }
    return best;
  }

  int n_;
  double noise_share_;
  Taken taken_;
  calib::Rig rig_;
  NoiseModel noise_;
  test::Normals normal_{11};
  PhaseMaps maps_;
};

TEST(MicroCode, small_patches_rarely_get_a_wrong_order) {
  constexpr std::array<double, 3> kNoise = {0.05, 0.1, 0.15}, kBound_pct = {0.01, 0.03, 0.23};
  for (std::size_t i = 0; i < kNoise.size(); ++i) {
    const Patches::Errors five = Patches(5, kNoise[i]).count(20'000), eight = Patches(8, kNoise[i]).count(5'000);
    EXPECT_LE(five.matched_pct, kBound_pct[i]) << kNoise[i];
    EXPECT_LE(five.evidence_pct, kBound_pct[i]) << kNoise[i];
    EXPECT_EQ(eight.matched_pct, 0) << kNoise[i];
    EXPECT_EQ(eight.evidence_pct, 0) << kNoise[i];
  }
}

TEST(MicroCode, single_pixels_and_a_code_frame_in_the_last_slot_are_no_good) {
  for (const double noise : {0.05, 0.1, 0.15}) {
    const Patches::Errors one = Patches(1, noise).count(20'000);
    EXPECT_NEAR(one.matched_pct, 63, 2) << noise;  // scaled freely, a sign is left; docs/notes/design-figures.md §2
    EXPECT_LT(one.evidence_pct, 37) << noise;      // 35 by design, counted on 20 000
    EXPECT_GT(one.evidence_pct, 9) << noise;
  }
  EXPECT_GT(Patches(5, 0.06, kLastOfEight).count(20'000).matched_pct, 1);
}

}  // namespace
}  // namespace enamel::pipeline
