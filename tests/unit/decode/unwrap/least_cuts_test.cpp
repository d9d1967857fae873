// Unwrapping without a code: what neighbours alone can tell, told rightly; and that the tests see it when it is not.
#include "pipeline/decode/unwrap/least_cuts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 160, kHeight = 200;
constexpr double kTwoPi = 2 * std::numbers::pi;

struct Field {
  PhaseMaps phase;
  Map<double> truth;  ///< fringes over the carrier's zero
  Map<float> carrier{kWidth, kHeight};
};

/// fringes: height of the surface in fringes; sigma: noise of the phase.
Field make_field(const std::function<double(int, int)>& fringes, double sigma) {
  Field f;
  f.phase.resize(kWidth, kHeight);
  f.truth = Map<double>(kWidth, kHeight);
  test::Normals normal(7);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double carrier = kTwoPi * u / 27, phi = carrier + kTwoPi * fringes(u, v);
      f.truth(u, v) = phi;
      f.carrier(u, v) = static_cast<float>(carrier);
      f.phase.phase_rad(u, v) = static_cast<float>(std::remainder(phi + sigma * normal(), kTwoPi));
      f.phase.sigma_rad(u, v) = static_cast<float>(sigma);
      f.phase.reject(u, v) = PixelReject::kNone;
    }
  }
  return f;
}

FloodMaps unwrap(const Field& f, LeastCutsWork& work, const CutConfig& config = {}) {
  FloodMaps out;
  unwrap_by_least_cuts(f.phase, {f.carrier.pixels().data(), 0.23F, 0.23F}, config, work, out);
  return out;
}

/// Valid pixels whose wrap count is not that of the pixel (0, 0), against the truth.
std::size_t wrong(const Field& f, const FloodMaps& found) {
  const auto offset = [&](std::size_t i) {
    return std::lround((static_cast<double>(f.phase.phase_rad[i]) - f.truth[i]) / kTwoPi) + found.wraps[i];
  };
  std::size_t count = 0;
  for (std::size_t i = 0; i < f.truth.size(); ++i)
    count += f.phase.reject[i] == PixelReject::kNone && offset(i) != offset(0) ? 1U : 0U;
  return count;
}

/// A cliff along column 80, far from every border, that grows from nothing to 1.6 fringes and back: in two places its
/// jump is a whole fringe, which neighbours do not see.
constexpr int kCliff = 80, kTop = 60, kBottom = 140;
double cliff(int u, int v) {
  if (u < kCliff || v < kTop || v > kBottom) return 0;
  return 1.6 * std::sin(std::numbers::pi * (v - kTop) / (kBottom - kTop)) * std::max(0.0, 1 - (u - kCliff) / 70.0);
}

TEST(LeastCuts, a_cliff_that_passes_through_a_whole_fringe_is_followed_from_end_to_end) {
  for (const double sigma : {0.02, 0.06, 0.12}) {
    LeastCutsWork work;
    const Field f = make_field(cliff, sigma);
    EXPECT_EQ(wrong(f, unwrap(f, work)), 0U) << sigma;
    EXPECT_GE(work.flow.residues(), 4U) << sigma;
  }
}

TEST(LeastCuts, turns_of_neighbours_alone_would_leak_through_that_cliff) {
  // The control: without the flow, one way round says another thing than the other.
  LeastCutsWork work;
  const Field f = make_field(cliff, 0.06);
  measure_cut_costs(f.phase, {f.carrier.pixels().data(), 0.23F, 0.23F}, {}, work.costs);
  const CutCosts& c = work.costs;
  int round = 0;  // round the residue where the jump passes through half a fringe: rows 50 … 80, columns 70 … 90
  const auto at = [&](int u, int v) {
    return static_cast<std::size_t>(v + 1) * c.stride + static_cast<std::size_t>(u) + 1;
  };
  for (int u = 70; u < 90; ++u) round += c.east_turn[at(u, 50)] - c.east_turn[at(u, 80)];
  for (int v = 50; v < 80; ++v) round += c.south_turn[at(90, v)] - c.south_turn[at(70, v)];
  EXPECT_NE(round, 0);
}

TEST(LeastCuts, every_quad_is_consistent_afterwards) {
  LeastCutsWork work;
  Field f = make_field(cliff, 0.9);  // noise that makes residues everywhere
  for (int v = 30; v < 50; ++v)
    for (int u = 55; u < 58; ++u) f.phase.reject(u, v) = PixelReject::kDark;
  (void)unwrap(f, work);
  EXPECT_GT(work.flow.residues(), 20U);
  const CutCosts& c = work.costs;
  const auto east = [&](std::size_t i) { return c.east_turn[i] + work.flow.east()[i]; };
  const auto south = [&](std::size_t i) { return c.south_turn[i] + work.flow.south()[i]; };
  std::size_t open = 0;
  for (std::size_t i = 0; i + c.stride + 1 < c.stride * c.rows; ++i) {
    if ((c.valid[i] & c.valid[i + 1] & c.valid[i + c.stride] & c.valid[i + c.stride + 1]) == 0) continue;
    open += east(i) + south(i + 1) - east(i + c.stride) - south(i) != 0 ? 1U : 0U;
  }
  EXPECT_EQ(open, 0U);
}

TEST(LeastCuts, a_smooth_surface_is_not_cut) {
  LeastCutsWork work;
  const Field f = make_field([](int u, int v) { return 1.5 * std::sin(0.03 * u) + 0.7 * std::cos(0.04 * v); }, 0.05);
  const FloodMaps found = unwrap(f, work);
  EXPECT_EQ(wrong(f, found), 0U);
  EXPECT_EQ(found.components, 1);
  EXPECT_EQ(work.flow.residues(), 0U);
}

/// A band of columns beside the cliff is masked.
Field with_band(PixelReject why) {
  Field f = make_field(cliff, 0.1);
  for (int v = 1; v < kHeight - 1; ++v)
    for (int u = kCliff - 4; u < kCliff - 2; ++u) f.phase.reject(u, v) = why;
  return f;
}

TEST(LeastCuts, pixels_masked_for_noise_are_no_hole_for_a_cut_to_slip_through) {
  LeastCutsWork work;
  const Field noisy = with_band(PixelReject::kNoisy);
  EXPECT_EQ(wrong(noisy, unwrap(noisy, work)), 0U);
  const Field dark = with_band(PixelReject::kDark);  // the control: a hole costs nothing
  EXPECT_GT(wrong(dark, unwrap(dark, work)), 0U);
}

TEST(LeastCuts, the_same_burst_gives_the_same_turns_in_used_memory) {
  LeastCutsWork work, fresh;
  const Field first = make_field(cliff, 0.5), second = make_field(cliff, 0.12);
  (void)unwrap(first, work);
  const FloodMaps a = unwrap(second, work), b = unwrap(second, fresh);
  EXPECT_TRUE(std::equal(a.wraps.pixels().begin(), a.wraps.pixels().end(), b.wraps.pixels().begin()));
  EXPECT_TRUE(std::equal(a.component.pixels().begin(), a.component.pixels().end(), b.component.pixels().begin()));
}

TEST(LeastCuts, nothing_valid_and_maps_without_numbers_do_no_harm) {
  LeastCutsWork work;
  Field f = make_field(cliff, 0.1);
  for (float& c : f.carrier.pixels()) c = std::nanf("");
  (void)unwrap(f, work);
  for (PixelReject& r : f.phase.reject.pixels()) r = PixelReject::kDark;
  EXPECT_EQ(unwrap(f, work).components, 0);
}

}  // namespace
}  // namespace enamel::pipeline
