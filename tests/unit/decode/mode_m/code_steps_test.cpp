// Jumps of whole fringes that leave the phase smooth.
#include "pipeline/decode/mode_m/code_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/decode/mode_m/micro_phase.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 160, kHeight = 40, kJump_px = 83;
constexpr double kPi = std::numbers::pi;

struct Seen {
  PhaseMaps phase;
  FloodMaps flood;
  NoiseModel noise;
  MicroCode code;
};

/// 26 px a fringe, and `orders` more from column kJump_px on; the flood does not know of the jump.
Seen see(int orders, double noise_share) {
  const calib::Rig rig = test::micro_rig(8, 8);
  test::Normals normal(5);
  test::FrameSet f{kWidth, kHeight, {}};
  Seen s;
  s.flood.wraps = Map<std::int16_t>(kWidth, kHeight);
  s.flood.component = Map<std::int32_t>(kWidth, kHeight, 0);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double smooth = 2 * kPi * (u + 0.3) / 26, phi = smooth + 2 * kPi * (u < kJump_px ? 0 : orders) + 40 * kPi;
      for (int k = 0; k < 4; ++k) {
        const double dn = 110 + 80 * (test::frame_wave(rig.patterns, k, phi, 0) + noise_share * normal());
        f.frames[static_cast<std::size_t>(k)].push_back(
            static_cast<std::uint8_t>(std::clamp(std::lround(dn), 0L, 255L)));
      }
    }
  }
  s.noise.floor_dn2 = static_cast<float>(std::pow(80 * noise_share, 2) + 1.0 / 12);
  s.code = make_micro_code(rig.patterns, rig.projector).value();
  compute_micro_phase(f.view(), s.noise, {}, s.phase);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      s.flood.wraps(u, v) = static_cast<std::int16_t>(
          std::lround((2 * kPi * (u + 0.3) / 26 - static_cast<double>(s.phase.phase_rad(u, v))) / (2 * kPi)));
    }
  }
  return s;
}

TEST(CodeSteps, jumps_of_one_to_three_fringes_are_cut_where_they_are) {
  for (const int orders : {-3, -2, -1, 1, 2}) {
    const Seen s = see(orders, 0.05);
    CodeSteps steps;
    find_code_steps(s.phase, s.noise, s.code, s.flood, 6.9F, steps);
    int exact = 0;
    for (int v = 0; v < kHeight; ++v) {
      int cuts = 0;
      for (int u = 0; u < kWidth; ++u) {
        if (steps.cut(u, v) == 0) continue;
        ++cuts;
        exact += std::abs(u - kJump_px) <= 1 ? 1 : 0;  // the windows leave one pixel out on either side
        EXPECT_NEAR(u, kJump_px, 3) << orders << " row " << v;
      }
      EXPECT_EQ(cuts, 1) << orders << " row " << v;
    }
    EXPECT_GE(exact, kHeight * 8 / 10) << orders;
  }
}

TEST(CodeSteps, a_surface_without_jumps_is_not_cut) {
  for (const double noise : {0.02, 0.1, 0.15}) {
    const Seen s = see(0, noise);
    CodeSteps steps;
    find_code_steps(s.phase, s.noise, s.code, s.flood, 6.9F, steps);
    for (const std::uint8_t cut : steps.cut.pixels()) ASSERT_EQ(cut, 0) << noise;
  }
}

/// Four pixels are lost to an edge on either side, but not to the image's border.
TEST(MicroEvidence, a_narrow_segment_at_the_images_border_is_heard) {
  constexpr int kOrder = 20, kCandidates = 5, kNarrow_px = 4;
  const Seen s = see(0, 0.02);
  const auto segment = [&](int begin) {
    Segment p;
    p.row = kHeight / 2, p.begin = begin, p.end = begin + kNarrow_px, p.component = 0;
    p.cell = 2 * s.flood.wraps(begin, p.row) - (s.phase.phase_rad(begin, p.row) < 0 ? 1 : 0);
    return p;
  };
  const std::vector<Segment> segments = {segment(0), segment(kWidth / 2), segment(kWidth - kNarrow_px)};
  MicroEvidence evidence;
  evidence.measure(s.phase, s.noise, segments, s.code, 4.6F);
  for (std::size_t k = 0; k < segments.size(); ++k) {
    std::array<float, kCandidates> nats{};
    evidence.costs(k, segments[k].cell + 2 * (kOrder - 2), nats);
    const auto [least, most] = std::minmax_element(nats.begin(), nats.end());
    if (k == 1) {
      EXPECT_EQ(*least, *most);  // nothing of it is left
    } else {
      EXPECT_EQ(least - nats.begin(), 2) << k;
      EXPECT_GT(*most - *least, 2) << k;
    }
  }
}

/// The sums of a row whose pixels know their fringe, against those of each pixel turned by it.
TEST(CodeSums, know_the_turns_of_the_flood) {
  const Seen s = see(0, 0.02);
  constexpr std::size_t kRow = 7;
  const std::int16_t* wraps = &s.flood.wraps(0, kRow);
  CodeSumRow wrapped, unwrapped;
  code_sums_of_row(s.phase, s.noise, s.code, kRow, wrapped);
  unwrapped_sums_of_row(s.phase, s.noise, s.code, wraps, kRow, unwrapped);
  double left_as_they_are = 0;
  for (std::size_t u = 0; u < kWidth; ++u) {
    const auto order = static_cast<std::size_t>(wraps[u]);
    const CodeSums want = turned(wrapped.at(u), s.code.cosine[order], s.code.sine[order]), found = unwrapped.at(u);
    const float size = want.xx + want.yy;
    EXPECT_NEAR(found.xx, want.xx, 1e-5F * size) << u;
    EXPECT_NEAR(found.xy, want.xy, 1e-5F * size) << u;
    EXPECT_NEAR(found.xd, want.xd, 1e-5F * size) << u;
    EXPECT_NEAR(found.yd, want.yd, 1e-5F * size) << u;
    EXPECT_EQ(found.dd, wrapped.at(u).dd) << u;
    left_as_they_are = std::max(left_as_they_are, static_cast<double>(std::abs(wrapped.at(u).xx - want.xx) / size));
  }
  EXPECT_GT(left_as_they_are, 0.1);
}

/// The labelling asks for all states of many segments at once.
TEST(MicroEvidence, says_of_states_together_what_it_says_of_cells_one_by_one) {
  constexpr int kFringe_px = 13, kSegments = 70;
  const Seen s = see(0, 0.05);
  std::vector<Segment> segments(kSegments);
  std::vector<std::int32_t> cells;
  for (int k = 0; k < kSegments; ++k) {
    Segment& p = segments[static_cast<std::size_t>(k)];
    p.row = k / 10, p.begin = k % 10 * kFringe_px, p.end = p.begin + kFringe_px;
    cells.push_back(k - 20);  // from before the frame on; the last states of the last segments lie beyond it
  }
  MicroEvidence evidence;
  evidence.measure(s.phase, s.noise, segments, s.code, 4.6F);
  std::vector<StateNats> together(kSegments);
  evidence.costs_of_states(0, cells, together.data());
  int asked = 0, beyond = 0, different = 0;
  for (std::size_t k = 0; k < kSegments; ++k) {
    for (std::size_t state = 0; state < kOrderStates; ++state) {
      const std::int32_t cell = cells[k] + 2 * static_cast<std::int32_t>(state);
      if (cell < 0 || cell >= evidence.cells()) {
        ++beyond;
        continue;
      }
      std::array<float, 1> one{};
      evidence.costs(k, cell, one);
      EXPECT_EQ(together[k][state], one[0]) << k << " state " << state;
      ++asked;
      if (cell < 2) continue;
      evidence.costs(k, cell - 2, one);
      different += together[k][state] == one[0] ? 0 : 1;
    }
  }
  EXPECT_GT(asked, kSegments * 4);
  EXPECT_GT(beyond, kSegments);
  EXPECT_GT(different, asked / 7);  // one order of seven is the segment's own, and costs less than the one before it
}

}  // namespace
}  // namespace enamel::pipeline
