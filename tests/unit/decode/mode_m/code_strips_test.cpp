#include "pipeline/decode/mode_m/code_strips.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

using pipeline::PixelReject;

constexpr int kWidth = 80, kHeight = 60, kStrip_px = 3;
constexpr float kEvidence = 12;

/// One run a row, whose left edge moves by `drift` pixels a row. Every pixel speaks for its order by 3 +- 2 but for a
/// strip along the left edge in the rows [from, to), which speaks by 1 +- 1 for one order less.
struct Edge {
  double drift = 0;
  int from = 0, to = 0;
  float of_others = -3;
  bool jump = false;  ///< the run begins where the order jumps, not beside a gap

  [[nodiscard]] int begin(int v) const { return 20 + static_cast<int>(std::abs(v - kHeight / 2) * drift); }
  [[nodiscard]] bool in_strip(int u, int v) const {
    return v >= from && v < to && u >= begin(v) && u < begin(v) + kStrip_px;
  }

  /// What becomes of the pixels; pixel (begin + 1, 0) was rejected before.
  [[nodiscard]] Map<PixelReject> judged(std::uint64_t seed, std::size_t* withdrawn = nullptr) const {
    Normals normal(seed);
    std::vector<pipeline::CellSpan> spans;
    for (int v = 0; v < kHeight; ++v) {
      if (jump) spans.push_back({v, begin(v) - 10, begin(v), 6, false});
      spans.push_back({v, begin(v), begin(v) + 9, 4, false});  // two cells, one run
      spans.push_back({v, begin(v) + 9, kWidth - 10, 5, false});
    }
    pipeline::CodeStrips strips;
    strips.find_ends(spans, kHeight);
    for (int v = 0; v < kHeight; ++v) {
      std::vector<float> more(kWidth), less(kWidth);
      for (int u = 0; u < kWidth; ++u) {
        const auto i = static_cast<std::size_t>(u);
        const auto noise = static_cast<float>(normal());
        more[i] = -3 + 2 * noise;
        less[i] = in_strip(u, v) ? 1 + noise : of_others - 2 * noise;
      }
      strips.take_row(v, {more.data(), less.data()});
    }
    Map<PixelReject> reject(kWidth, kHeight, PixelReject::kNone);
    reject(begin(0) + 1, 0) = PixelReject::kEdge;
    const std::size_t n = strips.withdraw(kEvidence, reject);
    if (withdrawn != nullptr) *withdrawn = n;
    return reject;
  }
};

std::size_t count(const Map<PixelReject>& reject, PixelReject why) {
  return static_cast<std::size_t>(std::count(reject.pixels().begin(), reject.pixels().end(), why));
}

TEST(CodeStrips, a_strip_of_three_pixels_is_found_along_its_edge) {
  for (const double drift : {0.0, 0.5, 1.0, 0.25}) {
    const Edge edge{.drift = drift, .from = 10, .to = 50, .jump = drift == 0.25};
    const Map<PixelReject> reject = edge.judged(1);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const bool inside = v >= 20 && v < 40 && edge.in_strip(u, v);  // ten rows are what a row is judged with
        if (inside) {
          EXPECT_EQ(reject(u, v), PixelReject::kRelative) << u << " " << v;
        }
        if (u >= edge.begin(v) + kStrip_px + 1) {
          EXPECT_EQ(reject(u, v), PixelReject::kNone) << u << " " << v;
        }
      }
    }
  }
}

TEST(CodeStrips, one_row_alone_says_too_little) {
  EXPECT_EQ(count(Edge{.from = 30, .to = 31}.judged(2), PixelReject::kRelative), 0U);
}

TEST(CodeStrips, noise_makes_no_strips) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed)
    EXPECT_EQ(count(Edge{.of_others = -2}.judged(seed), PixelReject::kRelative), 0U) << seed;
}

TEST(CodeStrips, what_was_rejected_before_keeps_its_reason) {
  const Edge edge{.from = 0, .to = kHeight};
  std::size_t withdrawn = 0;
  const Map<PixelReject> reject = edge.judged(3, &withdrawn);
  EXPECT_EQ(reject(edge.begin(0) + 1, 0), PixelReject::kEdge);
  EXPECT_EQ(count(reject, PixelReject::kRelative), withdrawn);
  EXPECT_GT(withdrawn, 150U);
}

}  // namespace
}  // namespace enamel::test
