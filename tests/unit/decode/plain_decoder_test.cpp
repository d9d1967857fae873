// The plain decoder itself: it must be right where the light is plain, or it is no floor for the product's.
#include "tests/support/plain_decoder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "calib/model/rig.hpp"
#include "tests/support/plain_floor.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/unit/decode/folder_burst.hpp"
#include "tests/unit/decode/folder_truth.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

constexpr int kWidth = 320, kHeight = 240;

/// Everything lit.
DepthTruth truth_of(const SyntheticBurst& burst) {
  const int w = burst.depth_mm.width(), h = burst.depth_mm.height();
  DepthTruth out{Map<float>(w, h), Map<std::uint8_t>(w, h, 1), {}};
  for (std::size_t i = 0; i < out.lit.size(); ++i) out.depth_mm[i] = static_cast<float>(burst.depth_mm[i]);
  out.edge = depth_edges(out.depth_mm);
  return out;
}

double tilted(int u, int v) { return 46 + 0.008 * u + 0.004 * v; }

/// A plane before one rig, decoded as if it were before another.
Floor decoded_plane(const calib::Rig& shown, const calib::Rig& believed) {
  const SyntheticBurst burst = render(shown, tilted, noisy());
  return floor_of(shown, truth_of(burst), plain_decode(believed, burst.frames.view()));
}

class PlainDecoder : public testing::TestWithParam<calib::PatternMode> {
 protected:
  static calib::Rig rig() {
    return GetParam() == calib::PatternMode::kMicro ? micro_rig(kWidth, kHeight, kShippedRatio)
                                                    : cropped_rig(kWidth, kHeight);
  }
  static calib::Rig rig_of_another_code() {
    calib::Rig other = rig();
    other.patterns.code_ratio = kDesignRatio;  // the two codes meet every 42 fringes only: not within this field
    for (int& polarity : other.patterns.polarity_code) polarity = -polarity;
    return other;
  }
};

TEST_P(PlainDecoder, places_a_plane_where_it_is) {
  const Floor f = decoded_plane(rig(), rig());
  EXPECT_GE(f.coverage(), 0.99);
  EXPECT_EQ(f.wrong, 0U);
}

TEST_P(PlainDecoder, places_nothing_right_by_a_foreign_code) {
  const Floor f = decoded_plane(rig(), rig_of_another_code());
  EXPECT_LE(static_cast<double>(f.placed - f.wrong), 0.01 * static_cast<double>(f.lit));
}

TEST_P(PlainDecoder, places_nothing_without_a_code) {
  SyntheticBurst burst = render(rig(), tilted, noisy());
  const std::size_t coded = GetParam() == calib::PatternMode::kMicro ? 1 : 3;
  std::ranges::fill(burst.frames.frames[coded], std::uint8_t{107});  // the mean light of noisy()
  const Floor f = floor_of(rig(), truth_of(burst), plain_decode(rig(), burst.frames.view()));
  EXPECT_EQ(f.placed, 0U);
}

INSTANTIATE_TEST_SUITE_P(Modes, PlainDecoder,
                         testing::Values(calib::PatternMode::kPolarity, calib::PatternMode::kMicro),
                         [](const auto& mode) { return mode.param == calib::PatternMode::kMicro ? "M" : "T"; });

/// Figures of an independent decoder of the same kind (shared/score/plain.py) for burst 0 of a set, measured.
struct Rendered {
  const char* set;
  double coverage, wrong_share;
};

class PlainOracle : public testing::TestWithParam<Rendered> {};

TEST_P(PlainOracle, agrees_with_an_independent_plain_decoder) {
  const std::string folder = shared_folder() + "/data/oracle/" + GetParam().set;
  const auto frames = load_folder_burst(folder, 0);
  const auto truth = load_folder_truth(folder, 0);
  if (!frames || !truth) GTEST_SKIP() << folder << " is absent";
  const calib::Rig rig = calib::load_rig(folder + "/rig.json").value();
  const Floor f = floor_of(rig, *truth, plain_decode(rig, frames->view()));
  EXPECT_NEAR(f.coverage(), GetParam().coverage, 0.01);
  EXPECT_NEAR(f.wrong_share(), GetParam().wrong_share, 0.001);
}

INSTANTIATE_TEST_SUITE_P(Sets, PlainOracle,
                         testing::Values(Rendered{"plane-01", 1, 0}, Rendered{"gamma2.5-M-02", 1, 0},
                                         Rendered{"steps-M-02", 0.859, 0.0041}, Rendered{"steps-T-02", 0.834, 0.0238}));

}  // namespace
}  // namespace enamel::test
