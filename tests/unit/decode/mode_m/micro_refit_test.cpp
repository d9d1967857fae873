// Mode M's code frame after the orders are known: motion within the burst, and a fourth frame for the phase.
#include "pipeline/decode/mode_m/micro_refit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "pipeline/decode/mode_m/micro_join.hpp"
#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "tests/support/fold_error.hpp"
#include "tests/unit/decode/dsim.hpp"

namespace enamel::pipeline {
namespace {

using namespace test::dsim;  // NOLINT: the vocabulary of these tests

constexpr int kWidth = 540, kHeight = 128;  ///< twenty fringes

struct Options {
  double noise = 0.03, motion_rad = 0, harmonic = 0, code_gain = 1;
  std::uint64_t seed = 1;
};

double phase_of(int i) {
  const int row = i / kWidth;
  return 2 * kPi * ((i % kWidth) + 0.37 + 0.2 * row) / 27;
}

/// A burst through the refit; every row's spans are its half fringes, as the decoder would have placed them.
struct Refit {
  MicroCode code;
  PhaseMaps three, before, maps;  ///< before: motion is undone
  Map<std::int16_t> wraps;
  std::vector<CellSpan> spans;
  MicroMotion motion;
  CodeStrips strips;
  NoiseModel noise;
  float third = 0;

  explicit Refit(const Options& o, bool saturated_code = false) {
    const calib::Rig rig = test::micro_rig(8, 8);
    code = make_micro_code(rig.patterns, rig.projector).value();
    test::Normals normal(o.seed);
    const auto frames = frames16(kWidth, kHeight, [&](int k, int i) {
      const double gain = k == 1 ? o.code_gain : 1;
      const double light = gain * test::frame_wave(rig.patterns, k, phase_of(i) + o.motion_rad * (k - 1.5), o.harmonic);
      return light + (o.noise > 0 ? o.noise * normal() : 0);
    });
    noise = noise16(std::max(o.noise, 1e-3));
    compute_micro_phase(frames.view(), noise, {}, maps);
    if (saturated_code) std::fill(maps.code_dn.pixels().begin(), maps.code_dn.pixels().end(), std::nanf(""));
    three = maps;
    place();
    third = estimate_third_harmonic(spans, maps).a1_rad;
    correct_third_harmonic(wraps, third, maps);
    fit_micro_motion({maps, wraps, code, third, noise}, {}, motion);
    before = maps;
    undo_micro_motion(wraps, motion, maps);
    join_code_frame({spans, wraps, code, motion, third, noise}, {}, maps, {strips});
  }

  [[nodiscard]] double rms_of(const PhaseMaps& m, bool over_sigma = false) const {
    double squares = 0, n = 0;
    for (const CellSpan& s : spans) {
      for (int u = s.begin; u < s.end; ++u) {
        const std::size_t i = m.phase_rad.index(u, s.row);
        const double e = wrap(static_cast<double>(m.phase_rad[i]) - phase_of(static_cast<int>(i)));
        squares += std::pow(e / (over_sigma ? static_cast<double>(m.sigma_rad[i]) : 1), 2), n += 1;
      }
    }
    return std::sqrt(squares / n);
  }

  [[nodiscard]] double ripple_of(const PhaseMaps& m) const {
    test::ErrorFolder folder;
    for (const CellSpan& s : spans) {
      for (int u = s.begin; u < s.end; ++u) {
        const std::size_t i = m.phase_rad.index(u, s.row);
        const double truth = phase_of(static_cast<int>(i));
        folder.add(wrap(static_cast<double>(m.phase_rad[i]) - truth), truth);
      }
    }
    return folder.result().repeating_rad;
  }

 private:
  /// The order of each pixel as its three-frame phase has it; cells end where that phase changes its sign.
  void place() {
    for (int v = 0; v < kHeight; ++v) {
      const std::size_t first = spans.size();
      for (int u = 0; u < kWidth; ++u) {
        const std::size_t i = maps.phase_rad.index(u, v);
        const auto phase = static_cast<double>(maps.phase_rad[i]);
        const auto turns = static_cast<int>(std::lround((phase_of(static_cast<int>(i)) - phase) / (2 * kPi)));
        const int cell = 2 * turns - (phase < 0 ? 1 : 0);
        if (u == 0 || spans.back().cell != cell) spans.push_back({v, u, u, cell, true});
        ++spans.back().end;
      }
      spans[first].whole = spans.back().whole = false;
    }
    place_spans(spans, {}, kWidth, kHeight, wraps);
  }
};

TEST(MicroRefit, code_frame_brings_the_noise_to_that_of_four_frames) {
  for (const double noise : {0.02, 0.05, 0.1}) {
    const Refit r({.noise = noise});
    EXPECT_NEAR(r.rms_of(r.three) / noise, 0.816, 0.02) << noise;
    EXPECT_NEAR(r.rms_of(r.maps) / noise, 0.726, 0.02) << noise;
    EXPECT_NEAR(r.rms_of(r.maps, true), 1, 0.03) << noise;  // and sigma says so
  }
}

TEST(MicroRefit, motion_is_found_and_its_ripple_undone) {
  for (const double motion : {-0.15, -0.067, 0.067, 0.15}) {
    const Refit r({.noise = 0.02, .motion_rad = motion});
    EXPECT_GT(r.ripple_of(r.three), 0.55 * std::abs(motion));  // the control: 0.88/sqrt 2 of it is there
    EXPECT_NEAR(r.motion.motion_rad, motion, 0.002);
    EXPECT_LT(r.ripple_of(r.maps), 0.0015);
    EXPECT_NEAR(r.rms_of(r.maps) / 0.02, 0.73, 0.06);
  }
}

TEST(MicroRefit, still_burst_keeps_still) {
  const Refit r({.noise = 0.05});
  EXPECT_LT(std::abs(r.motion.motion_rad), 0.002);
  EXPECT_NEAR(r.motion.gain, 1, 0.01);
}

TEST(MicroRefit, blur_of_the_finer_fringe_is_found_as_gain) {
  const Refit r({.code_gain = 0.75});
  EXPECT_NEAR(r.motion.gain, 0.75, 0.01);
  EXPECT_NEAR(r.rms_of(r.maps, true), 1, 0.03);
}

TEST(MicroRefit, second_harmonic_does_not_come_back_by_the_code) {
  const Refit r({.noise = 0.02, .harmonic = 0.02});
  EXPECT_GT(r.ripple_of(r.three), 0.012);
  EXPECT_LT(r.ripple_of(r.maps), 0.002);
  EXPECT_LT(std::abs(r.motion.motion_rad), 0.003);
}

TEST(MicroRefit, without_a_code_frame_the_three_frame_solution_stays) {
  const Refit r({}, true);
  EXPECT_EQ(r.motion.motion_rad, 0);
  for (std::size_t i = 0; i < r.maps.sigma_rad.size(); ++i)
    ASSERT_NEAR(r.maps.sigma_rad[i], r.three.sigma_rad[i], 1e-6);
  EXPECT_NEAR(r.rms_of(r.maps), r.rms_of(r.three), 1e-4);
}

/// Pixels at which a map differs.
template <class T>
std::size_t differing(const Map<T>& a, const Map<T>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0U : 1U;
  return count;
}

TEST(MicroRefit, row_by_row_gives_the_bits_of_one_step_after_the_other) {
  const Refit r({.noise = 0.02, .motion_rad = 0.1});
  const CodeJoin join{r.spans, r.wraps, r.code, r.motion, r.third, r.noise};
  CodeStrips strips;
  std::vector<float> scratch;
  PhaseMaps together = r.before, left_in = r.before;
  undo_motion_and_join(join, {}, together, {strips}, scratch);
  EXPECT_EQ(differing(together.phase_rad, r.maps.phase_rad), 0U);
  EXPECT_EQ(differing(together.sigma_rad, r.maps.sigma_rad), 0U);
  EXPECT_EQ(differing(together.reject, r.maps.reject), 0U);
  join_code_frame(join, {}, left_in, {strips});
  EXPECT_GT(differing(left_in.phase_rad, r.maps.phase_rad), r.maps.phase_rad.size() / 2);
}

TEST(MicroRefit, stretches_without_a_surface_stay_as_they_are) {
  const Refit r({.noise = 0.02, .motion_rad = 0.1});
  constexpr int kBegin = 77, kEnd = 300;
  Map<std::int16_t> wraps = r.wraps;
  for (int v = 0; v < kHeight; v += 2) std::fill(&wraps(kBegin, v), &wraps(kEnd, v), kNoWraps);
  PhaseMaps maps = r.before, whole = r.before;
  undo_micro_motion(wraps, r.motion, maps);
  undo_micro_motion(r.wraps, r.motion, whole);
  std::size_t moved = 0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const bool surface = wraps(u, v) != kNoWraps;
      ASSERT_EQ(maps.phase_rad(u, v), (surface ? whole : r.before).phase_rad(u, v)) << u << ' ' << v;
      moved += maps.phase_rad(u, v) == r.before.phase_rad(u, v) ? 0U : 1U;
    }
  }
  EXPECT_GT(moved, maps.phase_rad.size() / 2);
}

}  // namespace
}  // namespace enamel::pipeline
