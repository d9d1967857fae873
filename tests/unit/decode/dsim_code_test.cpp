// Figures of docs/notes/design-figures.md §2 made anew: what the two codes can tell, without the decoder around them.
#include <gtest/gtest.h>

#include <array>

#include "tests/unit/decode/dsim.hpp"

namespace enamel::pipeline {
namespace {

using namespace test::dsim;  // NOLINT: the vocabulary of these tests

constexpr std::array<int, 16> kCode = {-1, 1, 1, 1, 1, -1, 1, -1, -1, -1, 1, 1, -1, -1, -1, 1};

int sign_of(int cell) { return kCode[static_cast<std::size_t>(((cell % 16) + 16) % 16)]; }
int cell_of(double phi) { return static_cast<int>(std::floor(phi / kPi)); }

TEST(DsimCode, difference_of_modulations_follows_the_closure_and_vanishes_at_its_zeros) {
  for (const double r : {0.01, -0.02}) {  // closure residual over B
    for (const double phi : even_phases(360)) {
      const double s3 = std::sin(phi), c = std::cos(phi), s4 = s3 - r / 2;
      EXPECT_NEAR(std::hypot(c, s4) - std::hypot(c, s3), -r / 2 * std::sin(phi), 0.3 * r * r);
    }
  }
  EXPECT_NEAR(std::hypot(1, 0.1) - 1, 0, 0.006);  // at phi = 0 a flip of any size is hardly seen
}

/// Mean and spread of T over half-fringe cells of 13 x 5 px.
TEST(DsimCode, spread_of_the_cell_statistic) {
  constexpr double kNoise = 0.05;
  constexpr int kCells = 4000;
  test::Normals normal(2);
  for (const int b : {1, -1}) {
    double sum = 0, squares = 0;
    for (int n = 0; n < kCells; ++n) {
      double dot = 0, energy = 0;
      for (int i = 0; i < 65; ++i) {
        const double phi = kPi * (i % 13 + 0.5) / 13;
        const double i0 = std::cos(phi) + kNoise * normal(), i1 = -std::sin(phi) + kNoise * normal();
        const double i2 = -std::cos(phi) + kNoise * normal(), i3 = b * std::sin(phi) + kNoise * normal();
        const double a = 0.5 * (i0 + i2), s = a - i1;
        dot += (i3 - a) * s, energy += s * s;
      }
      sum += dot / energy, squares += std::pow(dot / energy, 2);
    }
    const double mean = sum / kCells, spread = std::sqrt(squares / kCells - mean * mean);
    EXPECT_NEAR(mean, b, 0.012);
    EXPECT_NEAR(spread, (b > 0 ? 2 : std::sqrt(2.0)) * kNoise / std::sqrt(65.0 / 2), 0.0006);
    EXPECT_NEAR(spread, 0.015, 0.003);  // the figure of the text, of both signs together
  }
}

/// Frames of the coded pattern behind gamma and blur, on a line of eight fringes and two more on each side.
class CodedLine {
 public:
  CodedLine(double gamma, double motion_rad, double blur_fringe) : motion_rad_(motion_rad) {
    for (int k = 0; k < 4; ++k) {
      std::vector<double> sharp;
      for (int i = 0; i < kPoints; ++i) {
        const double phi = phase(i);
        sharp.push_back(Gamma{gamma}(phi + (k == 3 && sign_of(cell_of(phi)) < 0 ? 1 : k) * kPi / 2));
      }
      frames_[static_cast<std::size_t>(k)] = blur(sharp, blur_fringe * kPerFringe);
    }
  }

  /// Least b T of the sixteen cells.
  [[nodiscard]] double worst() const {
    double least = 10;
    for (int cell = 0; cell < 16; ++cell) {
      double dot = 0, energy = 0;
      for (int i = 2 * kPerFringe + cell * kPerFringe / 2; i < 2 * kPerFringe + (cell + 1) * kPerFringe / 2; ++i) {
        const double a = 0.5 * (seen(0, i) + seen(2, i)), s = a - seen(1, i);
        dot += (seen(3, i) - a) * s, energy += s * s;
      }
      least = std::min(least, sign_of(cell) * dot / energy);
    }
    return least;
  }

 private:
  static constexpr int kPerFringe = 256, kPoints = 12 * kPerFringe;
  static double phase(int i) { return 2 * kPi * (i + 0.5) / kPerFringe - 4 * kPi; }

  static std::vector<double> blur(const std::vector<double>& sharp, double sigma) {
    if (sigma <= 0) return sharp;
    const int reach = static_cast<int>(4 * sigma), n = static_cast<int>(sharp.size());
    std::vector<double> out;
    for (int i = 0; i < n; ++i) {
      double sum = 0, total = 0;
      for (int j = std::max(-reach, -i); j <= std::min(reach, n - 1 - i); ++j) {
        const double w = std::exp(-0.5 * j * j / (sigma * sigma));
        sum += w * sharp[static_cast<std::size_t>(i + j)], total += w;
      }
      out.push_back(sum / total);
    }
    return out;
  }

  /// Frame k at point i, the pattern moved on by its own time.
  [[nodiscard]] double seen(int k, int i) const {
    const double x = i + motion_rad_ * (k - 1.5) * kPerFringe / (2 * kPi);
    const auto at = static_cast<std::size_t>(x);
    const auto& f = frames_[static_cast<std::size_t>(k)];
    return f[at] + (x - static_cast<double>(at)) * (f[at + 1] - f[at]);
  }

  double motion_rad_;
  std::array<std::vector<double>, 4> frames_;
};

/// The design has 0.94 for the clean pattern and 0.41, 0.57, 0.50; docs/notes/design-figures.md §2.
TEST(DsimCode, worst_cell_of_gamma_motion_and_blur) {
  EXPECT_NEAR(CodedLine(1, 0, 0).worst(), 1.00, 0.01);
  EXPECT_NEAR(CodedLine(1.5, 0, 0).worst(), 0.71, 0.02);
  EXPECT_NEAR(CodedLine(2.2, 0, 0).worst(), 0.37, 0.02);
  EXPECT_NEAR(CodedLine(1, 0.2, 0).worst(), 0.60, 0.01);
  EXPECT_NEAR(CodedLine(1.2, 0.2, 0.15).worst(), 0.58, 0.01);
  for (const double motion : {-0.2, 0.2})
    EXPECT_GT(CodedLine(1.2, motion, 0.15).worst(), 0.35);  // the design's own gate
}

/// Share, %, of patches whose cheapest of five orders is a wrong one. 27 px a fringe, 15 rows, no other knowledge.
double wrong_patches(int width_px, double noise, int patches) {
  test::Normals normal(9);
  int wrong = 0;
  for (int n = 0; n < patches; ++n) {
    const double start = 16 * kPi * std::fmod(n * 0.6180339887498949, 1.0);
    const int truth = n % 5;
    std::array<double, 5> cost{};
    for (int i = 0; i < 15 * width_px; ++i) {
      const double phi = start + 2 * kPi * (i % width_px) / 27;
      const int cell = cell_of(phi);
      const double i0 = std::cos(phi) + noise * normal(), i1 = -std::sin(phi) + noise * normal();
      const double i2 = -std::cos(phi) + noise * normal(), i3 = sign_of(cell) * std::sin(phi) + noise * normal();
      const double a = 0.5 * (i0 + i2), s = a - i1, d = i3 - a;
      for (int k = 0; k < 5; ++k)
        cost[static_cast<std::size_t>(k)] += std::pow(d - sign_of(cell + 2 * (k - truth)) * s, 2);
    }
    wrong += std::min_element(cost.begin(), cost.end()) - cost.begin() != truth ? 1 : 0;
  }
  return 100.0 * wrong / patches;
}

/// The design has 0.05 to 0.9 % for patches one fringe wide; docs/notes/design-figures.md §2.
TEST(DsimCode, patches_of_one_fringe_and_of_less_than_half) {
  EXPECT_NEAR(wrong_patches(27, 0.03, 3000), 2.4, 0.9);
  EXPECT_NEAR(wrong_patches(27, 0.1, 3000), 3.4, 1.0);
  EXPECT_LT(wrong_patches(41, 0.1, 2000), 0.9);  // one and a half fringes are enough
  EXPECT_GT(wrong_patches(13, 0.03, 2000), 25);
  EXPECT_GT(wrong_patches(10, 0.1, 2000), 25);
}

/// Mode M: share, %, of 5 x 5 patches whose best-matched order of five is wrong. code_at: time of the code frame, in
/// frame intervals from mid-burst; the phase frames take the other slots.
double wrong_micro_patches(double ratio, double code_at, double motion_rad, double noise) {
  constexpr int kPatches = 3000, kPixels = 25;
  test::Normals normal(13);
  std::vector<double> at;
  for (const double t : {-1.5, -0.5, 0.5, 1.5})
    if (t != code_at) at.push_back(t);
  const double code = 1 + 1 / ratio, gain = std::exp(-2 * kPi * kPi * 0.01 * (code * code - 1));  // blur of 0.1 fringe
  const auto wave = [](double p) { return std::cos(p) + 0.01 * std::cos(2 * p); };
  int wrong = 0;
  for (int n = 0; n < kPatches; ++n) {
    const double start = 2 * kPi * (10 + n % 5 + std::fmod(n * 0.6180339887498949, 1.0));
    std::array<double, 5> dot{}, energy{};
    for (int i = 0; i < kPixels; ++i) {
      const double phi = start + 2 * kPi * (i % 5) / 27;
      std::array<double, 3> f{};
      for (std::size_t k = 0; k < 3; ++k)
        f[k] = wave(phi + 2 * kPi * static_cast<double>(k) / 3 + motion_rad * at[k]) + noise * normal();
      const double d = gain * wave((phi + motion_rad * code_at) * code) + noise * normal() - (f[0] + f[1] + f[2]) / 3;
      const double seen = phi + wrap(std::atan2((f[2] - f[1]) / std::sqrt(3.0), (2 * f[0] - f[1] - f[2]) / 3) - phi);
      for (int k = 0; k < 5; ++k) {
        const double c = std::cos((seen + 2 * kPi * (k - n % 5)) * code);
        dot[static_cast<std::size_t>(k)] += d * c, energy[static_cast<std::size_t>(k)] += c * c;
      }
    }
    std::size_t best = 0;
    for (std::size_t k = 1; k < 5; ++k)
      if (dot[k] / std::sqrt(energy[k]) > dot[best] / std::sqrt(energy[best])) best = k;
    wrong += static_cast<int>(best) != n % 5 ? 1 : 0;
  }
  return 100.0 * wrong / kPatches;
}

/// Contradicted: ratio 5 does not hold to 0.3 rad a frame, and the last slot has 1.5 and 3 % where 3.9 % are given;
/// docs/notes/design-figures.md §2.
TEST(DsimCode, the_second_slot_holds_where_the_last_collapses) {
  EXPECT_LT(wrong_micro_patches(6, -0.5, 0.1, 0.06), 0.1);
  EXPECT_LT(wrong_micro_patches(6, -0.5, 0.2, 0.06), 0.5);
  EXPECT_NEAR(wrong_micro_patches(6, -0.5, 0.3, 0.06), 9.6, 2);
  EXPECT_LT(wrong_micro_patches(5, -0.5, 0.1, 0.06), 0.1);
  EXPECT_NEAR(wrong_micro_patches(5, -0.5, 0.3, 0.06), 12.6, 2);
  EXPECT_NEAR(wrong_micro_patches(8, 1.5, 0.1, 0.06), 1.5, 0.8);
  EXPECT_NEAR(wrong_micro_patches(8, 1.5, -0.1, 0.06), 3.0, 1);
  EXPECT_GT(wrong_micro_patches(8, 1.5, 0.15, 0.06), 10);
}

TEST(DsimCode, a_code_fringe_of_thirteen_twelfths_is_fragile) {
  const double six = wrong_micro_patches(6, -0.5, 0.1, 0.1), twelve = wrong_micro_patches(12, -0.5, 0.1, 0.1);
  EXPECT_LT(six, 0.3);
  EXPECT_GT(twelve, 10 * six + 1);
}

}  // namespace
}  // namespace enamel::pipeline
