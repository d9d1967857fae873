// Surfaces many fringes apart in one component of the flood: each is asked about its own shifts.
#include "pipeline/decode/unwrap/order_windows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <ranges>

namespace enamel::pipeline {
namespace {

constexpr std::int32_t kRows = 30, kWide_px = 12;
constexpr std::int32_t kSilent = -1;  ///< a segment without a word of its own

/// A code that knows some segments' absolute cells.
class KnownCells final : public CodeEvidence {
 public:
  explicit KnownCells(const std::vector<std::int32_t>& cell) : cell_(cell) {}

  [[nodiscard]] int cells() const override { return 200; }
  [[nodiscard]] int repeats_after() const override { return 0; }
  void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const override {
    for (float& cost : out) {
      cost = cell_[segment] == kSilent || cell_[segment] == first_cell ? 0 : 4.6F;
      first_cell += 2;
    }
  }
  [[nodiscard]] Stance stance(std::size_t segment, std::int32_t at) const override {
    if (cell_[segment] == kSilent) return Stance::kSilent;
    return cell_[segment] == at ? Stance::kAgrees : Stance::kContradicts;
  }

 private:
  const std::vector<std::int32_t>& cell_;
};

struct Scene {
  std::vector<Segment> segments;
  std::vector<std::int32_t> code;   ///< absolute cells that the code tells
  std::vector<std::int32_t> truth;  ///< shift; of the leak's segments any

  /// A segment at the row's end; low ... high: what the depth range allows.
  void add(std::int32_t row, std::int32_t cell, std::int32_t low, std::int32_t high, std::int32_t shift, bool heard) {
    Segment p;
    p.row = row, p.component = 0, p.cell = cell, p.low = low, p.high = high;
    const bool follows = !segments.empty() && segments.back().row == row;
    p.begin = follows ? segments.back().end : 0, p.end = p.begin + kWide_px;
    p.joined = follows;
    constexpr auto kPi = std::numbers::pi_v<float>;
    p.first_rad = static_cast<float>(cell) * kPi + 0.1F, p.last_rad = static_cast<float>(cell + 1) * kPi - 0.1F;
    const auto above =
        std::ranges::find_if(segments, [&](const Segment& o) { return o.row == row - 1 && o.cell == cell; });
    if (above != segments.end()) {
      p.up = static_cast<std::int32_t>(above - segments.begin());
      above->down = static_cast<std::int32_t>(segments.size());
    }
    segments.push_back(p);
    truth.push_back(shift);
    code.push_back(heard ? cell + 2 * shift : kSilent);
  }

  [[nodiscard]] OrderResult solve() const {
    OrderResult out;
    find_orders(segments, 1, KnownCells(code), {}, out);
    return out;
  }

  [[nodiscard]] std::size_t found(const OrderResult& by) const {
    std::size_t n = 0;
    for (std::size_t i = 0; i < segments.size(); ++i)
      n += by.segments[i].decided && by.segments[i].shift == truth[i] ? 1U : 0U;
    return n;
  }
};

/// Six segments of a surface, six of another whose flood number is 18 fringes off, and between them in three rows a
/// leak that climbs from one to the other.
Scene two_surfaces_and_a_leak() {
  Scene scene;
  for (std::int32_t row = 0; row < kRows; ++row) {
    for (std::int32_t c = 0; c < 6; ++c) scene.add(row, c, 8, 12, 10, true);
    const bool leaks = row >= 10 && row < 13;
    for (std::int32_t c = 6; c < 42 && leaks; ++c) scene.add(row, c, 8 - c / 2, 12 - c / 2, 0, false);
    for (std::int32_t c = 42; c < 48; ++c) scene.add(row, c, -10, -6, -8, true);
    if (!leaks) scene.segments[scene.segments.size() - 6].joined = false;
  }
  return scene;
}

TEST(OrderWindows, surfaces_that_a_leak_joins_are_each_found_at_their_own_shift) {
  const Scene scene = two_surfaces_and_a_leak();
  const OrderResult r = scene.solve();
  for (std::size_t i = 0; i < scene.segments.size(); ++i) {
    if (scene.code[i] == kSilent) continue;
    EXPECT_TRUE(r.segments[i].decided && r.segments[i].shift == scene.truth[i]) << i;
  }
}

TEST(OrderWindows, every_segment_has_its_range_and_what_lies_just_beyond_it) {
  const Scene scene = two_surfaces_and_a_leak();
  const OrderResult r = scene.solve();
  for (std::size_t i = 0; i < scene.segments.size(); ++i) {
    EXPECT_LE(r.work.base[i], scene.segments[i].low - kBeyond) << i;
    EXPECT_GE(r.work.base[i] + static_cast<std::int32_t>(kOrderStates) - 1, scene.segments[i].high + kBeyond) << i;
  }
}

TEST(OrderWindows, a_component_that_fits_has_one_base) {
  Scene scene;
  for (std::int32_t row = 0; row < 7; ++row)
    for (std::int32_t c = 0; c < 6; ++c) scene.add(row, c, row, row + 4, 5, true);
  const OrderResult r = scene.solve();
  EXPECT_TRUE(std::ranges::all_of(r.work.base, [](std::int32_t b) { return b == -kBeyond; }));
}

/// Nine orders a pixel: a window holds four neighbouring ranges, and a surface across which the range moves by eight
/// orders has three.
TEST(OrderWindows, what_a_segment_knows_crosses_windows_along_a_row) {
  Scene scene;
  for (std::int32_t k = 0; k < 9; ++k) scene.add(0, k, k, k + 8, 8, k < 2);
  const OrderResult r = scene.solve();
  EXPECT_GT(r.work.base[8], r.work.base[0]);
  EXPECT_EQ(scene.found(r), scene.segments.size());
}

TEST(OrderWindows, what_a_row_knows_crosses_windows_to_the_next) {
  Scene scene;
  for (std::int32_t row = 0; row < 9; ++row)
    for (std::int32_t c = 0; c < 6; ++c) scene.add(row, c, row, row + 8, 8, row < 2);
  const OrderResult r = scene.solve();
  EXPECT_GT(r.work.base.back(), r.work.base.front());
  EXPECT_EQ(scene.found(r), scene.segments.size());
}

TEST(OrderWindows, segments_without_a_place_in_the_range_are_no_reason_to_fail) {
  Scene scene = two_surfaces_and_a_leak();
  scene.add(kRows, 0, 1'000'000, -1'000'000, 0, false);
  scene.add(kRows, 1, -1'000'000, -1'000'001, 0, false);
  const OrderResult r = scene.solve();
  EXPECT_GE(scene.found(r), std::size_t{kRows * 12});
  EXPECT_FALSE(r.segments.back().decided);
}

}  // namespace
}  // namespace enamel::pipeline
