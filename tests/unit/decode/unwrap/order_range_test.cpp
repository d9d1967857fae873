// A surface at one end of the depth range, whose code is the same again a little beyond the other end.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "pipeline/decode/unwrap/order.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::int32_t kWide_px = 12, kCells = 6, kPeriod = 7;

/// Tells a segment's order up to whole periods.
class RepeatingCode final : public CodeEvidence {
 public:
  /// faint: segments that cost as others do, as by noise, but are too faint to be asked.
  explicit RepeatingCode(const std::vector<std::int32_t>& cell, bool faint = false) : cell_(cell), faint_(faint) {}

  [[nodiscard]] int cells() const override { return 200; }
  [[nodiscard]] int repeats_after() const override { return kPeriod; }
  void costs(std::size_t segment, std::int32_t first_cell, std::span<float> out) const override {
    for (float& cost : out) {
      cost = same(segment, first_cell) ? 0 : 8.4F;
      first_cell += 2;
    }
  }
  [[nodiscard]] Stance stance(std::size_t segment, std::int32_t at) const override {
    if (faint_) return Stance::kSilent;
    return same(segment, at) ? Stance::kAgrees : Stance::kContradicts;
  }

 private:
  [[nodiscard]] bool same(std::size_t segment, std::int32_t at) const {
    return (at - cell_[segment]) % (2 * kPeriod) == 0;
  }

  const std::vector<std::int32_t>& cell_;
  bool faint_;
};

/// Rows of one smooth surface, as far as the phase tells.
struct Scene {
  std::vector<Segment> segments;
  std::vector<std::int32_t> code;

  /// low ... high: what the depth range allows.
  void add_rows(std::int32_t count, std::int32_t low, std::int32_t high, std::int32_t shift) {
    constexpr auto kPi = std::numbers::pi_v<float>;
    const std::int32_t first = segments.empty() ? 0 : segments.back().row + 1;
    for (std::int32_t row = first; row < first + count; ++row) {
      for (std::int32_t c = 0; c < kCells; ++c) {
        Segment p;
        p.row = row, p.component = 0, p.cell = c, p.low = low, p.high = high;
        p.begin = c * kWide_px, p.end = p.begin + kWide_px, p.joined = c > 0;
        p.first_rad = static_cast<float>(c) * kPi + 0.1F, p.last_rad = static_cast<float>(c + 1) * kPi - 0.1F;
        const auto here = static_cast<std::int32_t>(segments.size());
        if (row > 0) p.up = here - kCells, segments[segments.size() - kCells].down = here;
        segments.push_back(p);
        code.push_back(c + 2 * shift);
      }
    }
  }

  [[nodiscard]] OrderResult solve() const {
    OrderResult out;
    find_orders(segments, 1, RepeatingCode(code), {}, out);
    return out;
  }
};

/// Segments of rows [first, end) that were decided at a shift.
int decided_at(const Scene& scene, std::int32_t first, std::int32_t end, std::int32_t shift) {
  const OrderResult r = scene.solve();
  int n = 0;
  for (std::size_t i = 0; i < scene.segments.size(); ++i) {
    const bool asked = scene.segments[i].row >= first && scene.segments[i].row < end;
    n += asked && r.segments[i].decided && r.segments[i].shift == shift ? 1 : 0;
  }
  return n;
}

TEST(OrderRange, a_surface_at_its_end_is_placed_though_others_border_on_it) {
  Scene scene;
  scene.add_rows(20, 10, 15, 12);
  scene.add_rows(40, 10, 15, 15);
  scene.add_rows(20, 10, 15, 11);
  EXPECT_EQ(decided_at(scene, 40, 50, 15), 10 * kCells);
  EXPECT_EQ(decided_at(scene, 0, 80, 8), 0);
}

TEST(OrderRange, a_surface_that_goes_on_beyond_it_is_not_folded_back) {
  Scene scene;
  scene.add_rows(20, 5, 10, 8);
  scene.add_rows(40, 10, 15, 8);
  scene.add_rows(20, 10, 15, 12);
  EXPECT_EQ(decided_at(scene, 0, 80, 15), 0);
}

TEST(OrderSeams, are_torn_where_codes_that_speak_jump_on_a_smooth_surface) {
  Scene scene;
  scene.add_rows(30, 8, 15, 12);
  OrderResult whole, jumping, faint;
  find_orders(scene.segments, 1, RepeatingCode(scene.code), {}, whole);
  EXPECT_EQ(whole.seams, 30U * (kCells - 1));
  EXPECT_EQ(whole.torn_seams, 0U);
  for (std::size_t i = 0; i < scene.code.size(); ++i) scene.code[i] += i % kCells < 3 ? 0 : 4;
  find_orders(scene.segments, 1, RepeatingCode(scene.code), {}, jumping);
  EXPECT_EQ(jumping.torn_seams, 30U);
  find_orders(scene.segments, 1, RepeatingCode(scene.code, true), {}, faint);
  EXPECT_EQ(faint.seams, 0U) << "noise makes a faint code jump: no proof of another one";
  EXPECT_EQ(faint.torn_seams, 0U);
}

}  // namespace
}  // namespace enamel::pipeline
