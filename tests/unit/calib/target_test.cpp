// Dots in images: centres against the bound of their pixels' noise, and which dot is which.
#include "calib/target/target.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "calib/target/disc_fit.hpp"
#include "calib/target/dot_grid.hpp"
#include "calib/target/edge_spread.hpp"
#include "protocol/base/rng.hpp"
#include "tests/support/disc_image.hpp"

namespace enamel::calib {
namespace {

using Eigen::Vector2d;
using test::bound_px;
using test::disc_image;
using test::noisy;

const PixelNoise kNoise = test::kDiscNoise;

constexpr double kReach_px = 12;

struct DiscCase {
  double radius_px, tilt_deg, blur_px;
};

class DiscCentre : public testing::TestWithParam<DiscCase> {};

TEST_P(DiscCentre, is_unbiased_and_near_its_bound) {
  const auto [radius, tilt, blur] = GetParam();
  const int side = static_cast<int>(2 * radius + 30);
  const double shorter = radius * std::cos(tilt * std::numbers::pi / 180), way = 0.4;
  Eigen::Matrix2d turn;
  turn << std::cos(way), -std::sin(way), std::sin(way), std::cos(way);
  Ellipse truth;
  truth.shape = turn * Vector2d(1 / (radius * radius), 1 / (shorter * shorter)).asDiagonal() * turn.transpose();
  Rng rng(static_cast<std::uint64_t>(radius * 100 + tilt), 0, 1);
  Vector2d sum(0, 0);
  double squares = 0, stated = 0, moments = 0;
  constexpr int kPhases = 6, kDraws = 20;
  for (int phase = 0; phase < kPhases; ++phase) {
    truth.centre = Vector2d(0.5 * side + rng.uniform(), 0.5 * side + rng.uniform());
    const Map<float> clean = disc_image(truth, blur, side);
    for (int draw = 0; draw < kDraws; ++draw) {
      const Map<float> image = noisy(clean, rng);
      Ellipse seed = truth;
      seed.centre += Vector2d(0.4, -0.3);
      seed.shape *= 1.1;
      const auto start = disc_moments(image, seed, kReach_px);
      ASSERT_TRUE(start);
      const auto fit = fit_disc(image, kNoise, *start, kReach_px, EdgeModel::kPixelThenTaps);
      ASSERT_TRUE(fit);
      const Vector2d error = fit->ellipse.centre - truth.centre;
      sum += error;
      squares += error.x() * error.x();
      stated += fit->covariance(0, 0);
      moments += std::pow(start->centre.x() - truth.centre.x(), 2);
    }
  }
  constexpr double kAll = kPhases * kDraws;
  const double sigma = std::sqrt(squares / kAll);
  truth.centre = Vector2d(0.5 * side, 0.5 * side);
  const double bound = bound_px(truth, blur, side);
  EXPECT_LT((sum / kAll).norm(), 0.005);
  // The scatter of 120 draws is known to 6.5 %.
  EXPECT_LT(sigma, 1.2 * bound * (1 + 2 * 0.065));
  RecordProperty("sigma_over_bound", std::to_string(sigma / bound));
  EXPECT_NEAR(std::sqrt(stated / kAll) / sigma, 1, 0.3);
  EXPECT_GT(std::sqrt(moments / kAll), sigma) << "moments alone: the start value must not be the better one";
}

INSTANTIATE_TEST_SUITE_P(Discs, DiscCentre,
                         testing::Values(DiscCase{9, 0, 0.6}, DiscCase{9, 45, 0.6}, DiscCase{12, 30, 0.8},
                                         DiscCase{18, 0, 0.6}, DiscCase{18, 45, 1.2}, DiscCase{36, 20, 0.6}));

TEST(DiscFit, gives_nothing_for_what_is_no_disc) {
  Map<float> flat(60, 60, 50.0F);
  Ellipse seed{{30, 30}, Eigen::Matrix2d::Identity() / 100};
  EXPECT_FALSE(fit_disc(flat, kNoise, seed, 6, EdgeModel::kLensThenPixel));
  seed.centre = {2, 30};
  EXPECT_FALSE(fit_disc(flat, kNoise, seed, 6, EdgeModel::kLensThenPixel)) << "leaves the image";
}

TEST(DiscFit, does_without_the_ground_that_lies_beyond_the_image) {
  constexpr int kSide = 80;
  const auto error_px = [](double ground_px) {
    const Ellipse truth{{kSide - 1 - 15 - ground_px, 40}, Eigen::Matrix2d::Identity() / (15.0 * 15.0)};
    const auto fit = fit_disc(disc_image(truth, 0.6, kSide), kNoise, truth, kReach_px, EdgeModel::kPixelThenTaps);
    return fit ? (fit->ellipse.centre - truth.centre).norm() : std::numeric_limits<double>::infinity();
  };
  EXPECT_LT(error_px(8.5), 0.005);
  EXPECT_EQ(error_px(7), std::numeric_limits<double>::infinity()) << "too little ground on that side";
}

TEST(EdgeSpread, derivatives_and_limits_are_those_of_the_edge) {
  for (const double way : {0.0, 0.3, std::numbers::pi / 4, 1.2, std::numbers::pi / 2}) {
    const Vector2d n(std::cos(way), std::sin(way));
    for (const double d : {-1.3, -0.4, 0.01, 0.6, 1.1}) {
      const EdgeSpread e = edge_spread(d, n, 0.6);
      const auto at = [&](double dd, double ds) { return edge_spread(d + dd, n, 0.6 + ds).cover; };
      EXPECT_NEAR(e.by_distance, (at(1e-5, 0) - at(-1e-5, 0)) / 2e-5, 1e-6);
      EXPECT_NEAR(e.by_blur, (at(0, 1e-5) - at(0, -1e-5)) / 2e-5, 1e-6);
      EXPECT_NEAR(e.cover + edge_spread(-d, n, 0.6).cover, 1, 1e-12);
    }
    EXPECT_EQ(edge_spread(9, n, 0.6).cover, 1);
    EXPECT_EQ(edge_spread(-9, n, 0.6).cover, 0);
  }
  // A sharp edge along a pixel row: the pixel's share on the inner side.
  EXPECT_NEAR(edge_spread(0.2, {0, 1}, 0).cover, 0.7, 1e-9);
  EXPECT_NEAR(edge_spread(0.1, {0, 1}, 0, 0, 0.5).cover, 0.7, 1e-9) << "of a square half as wide";
}

/// Half axes 9 and 6.4 px: radius of curvature 4.5 px.
Ellipse tilted_disc() {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(0.4).toRotationMatrix();
  Ellipse e{{24.3, 23.8}, {}};
  e.shape = turn * Vector2d(1 / 81.0, 2 / 81.0).asDiagonal() * turn.transpose();
  return e;
}

TEST(DiscCover, is_the_integral_over_each_pixel) {
  constexpr int kSide = 48;
  const Ellipse e = tilted_disc();
  const Map<float> image = disc_image(e, 0.6, kSide);
  DiscCover cover(EdgeModel::kPixelThenTaps, {0, 0, kSide - 1, kSide - 1}, e);
  cover.render(e, 0.6);
  double squares = 0;
  for (int v = 0; v < kSide; ++v)
    for (int u = 0; u < kSide; ++u) {
      const double expected = (static_cast<double>(image(u, v)) - 25) / 115;  // levels of disc_image
      squares += std::pow(cover.at({u, v}).cover - expected, 2);
    }
  // Along the contour alone: about one pixel in ten. A pixel taken as one square leaves eight times as much.
  EXPECT_LT(std::sqrt(squares / (0.1 * kSide * kSide)), 2e-4);
}

TEST(DiscCover, slopes_are_those_of_the_cover) {
  constexpr int kSide = 48;
  constexpr double kBlur_px = 0.7, kStep = 1e-5;
  for (const EdgeModel model : {EdgeModel::kLensThenPixel, EdgeModel::kPixelThenTaps}) {
    const Ellipse e = tilted_disc();
    DiscCover at(model, {0, 0, kSide - 1, kSide - 1}, e), plus = at, minus = at;
    at.render(e, kBlur_px);
    const auto expect_slope = [&](Eigen::Index which, double step, const auto& change) {
      Ellipse a = e, b = e;
      double blur_a = kBlur_px, blur_b = kBlur_px;
      change(a, blur_a, step);
      change(b, blur_b, -step);
      plus.render(a, blur_a);
      minus.render(b, blur_b);
      double off = 0, size = 0;
      for (int v = 0; v < kSide; ++v)
        for (int u = 0; u < kSide; ++u) {
          const Vector2d p(u, v);
          const double slope = (plus.at(p).cover - minus.at(p).cover) / (2 * step);
          off += std::pow(at.at(p).slope[which] - slope, 2);
          size += slope * slope;
        }
      // Taken at the contour, to first order in the distance from it.
      EXPECT_LT(std::sqrt(off / size), 0.1) << which;
    };
    expect_slope(0, kStep, [](Ellipse& a, double& /*blur*/, double h) { a.centre.x() += h; });
    expect_slope(1, kStep, [](Ellipse& a, double& /*blur*/, double h) { a.centre.y() += h; });
    expect_slope(2, 1e-3 * kStep, [](Ellipse& a, double& /*blur*/, double h) { a.shape(0, 0) += h; });
    expect_slope(3, 1e-3 * kStep, [](Ellipse& a, double& /*blur*/, double h) {
      a.shape(0, 1) += h;
      a.shape(1, 0) += h;
    });
    expect_slope(4, 1e-3 * kStep, [](Ellipse& a, double& /*blur*/, double h) { a.shape(1, 1) += h; });
    expect_slope(5, kStep, [](Ellipse& /*a*/, double& blur, double h) { blur += h; });
  }
}

// Grids -------------------------------------------------------------------------------------------------------------

TargetDesign design_9x7() {
  return parse_target(R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": 2, "radius_mm": 0.35})").value();
}

struct GridView {
  double roll_deg = 0;
  double perspective = 0;
  std::set<int> missing;
  std::set<int> rings;
  Vector2d middle{320, 240};
  double pitch_px = 44;
};

Vector2d image_of(const TargetDesign& t, int dot, const GridView& view) {
  const Vec3d p = t.place(dot) / t.pitch_mm;
  const double a = view.roll_deg * std::numbers::pi / 180;
  // y up in the image: z towards the camera.
  const Vector2d q(std::cos(a) * p.x() - std::sin(a) * p.y(), -(std::sin(a) * p.x() + std::cos(a) * p.y()));
  return view.middle + view.pitch_px * q / (1 + view.perspective * (q.x() + 0.5 * q.y()));
}

void paint(Map<float>& image, const TargetDesign& t, const GridView& view) {
  const double radius = view.pitch_px * t.radius_mm / t.pitch_mm;
  for (int i = 0; i < t.size(); ++i) {
    if (view.missing.contains(i)) continue;
    const Vector2d c = image_of(t, i, view);
    for (int v = 0; v < image.height(); ++v)
      for (int u = 0; u < image.width(); ++u) {
        const double d = radius - (Vector2d(u, v) - c).norm();
        const bool hole = view.rings.contains(i) && d > 0.55 * radius;
        if (d > -0.5 && !hole) image(u, v) = static_cast<float>(30 + 100 * std::min(1.0, d + 0.5));
      }
  }
}

void expect_all_found(const TargetDesign& t, const GridView& view) {
  Map<float> image(640, 480, 30.0F);
  paint(image, t, view);
  const auto grid = find_dot_grid(image, t);
  ASSERT_TRUE(grid) << grid.error().message();
  EXPECT_EQ(grid->dots.size(), static_cast<std::size_t>(t.size()) - view.missing.size());
  for (const GridDot& dot : grid->dots)
    EXPECT_LT((dot.blob.centre - image_of(t, dot.index, view)).norm(), 1.0) << dot.index;
}

TEST(DotGrid, orders_dots_at_any_roll_within_ninety_degrees) {
  for (const double roll : {0.0, 20.0, -35.0, 50.0, -80.0, 85.0})
    expect_all_found(design_9x7(), {.roll_deg = roll, .missing = {}, .rings = {}, .pitch_px = 40});
}

TEST(DotGrid, missing_dots_and_perspective_do_not_shift_the_order) {
  expect_all_found(design_9x7(),
                   {.roll_deg = 10, .perspective = 0.03, .missing = {0, 31, 40}, .rings = {}, .pitch_px = 38});
  expect_all_found(design_9x7(),
                   {.roll_deg = -25, .perspective = -0.04, .missing = {30, 31, 39, 22}, .rings = {}, .pitch_px = 38});
}

TEST(DotGrid, rings_tell_which_way_up) {
  TargetDesign t = design_9x7();
  t.marks = {{2, 1}, {6, 1}, {2, 4}};
  const std::set<int> rings{t.index({2, 1}), t.index({6, 1}), t.index({2, 4})};
  for (const double roll : {0.0, 120.0, 180.0, -100.0})
    expect_all_found(t, {.roll_deg = roll, .missing = {}, .rings = rings, .pitch_px = 40});
  Map<float> image(640, 480, 30.0F);
  paint(image, t, {.missing = {}, .rings = {}});
  EXPECT_FALSE(find_dot_grid(image, t)) << "rings that are not there";
}

TEST(DotGrid, wrong_target_is_named_with_both_sizes) {
  TargetDesign other = design_9x7();
  other.cols = 11;
  Map<float> image(640, 480, 30.0F);
  paint(image, design_9x7(), {.missing = {}, .rings = {}});
  const auto grid = find_dot_grid(image, other);
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().code, ErrorCode::kTargetNotFound);
  EXPECT_THAT(grid.error().detail, testing::AllOf(testing::HasSubstr("11 x 7"), testing::HasSubstr("9 x 7")));
}

TEST(DotGrid, two_targets_in_view_are_refused) {
  Map<float> image(640, 480, 30.0F);
  paint(image, design_9x7(), {.missing = {}, .rings = {}, .middle = {160, 130}, .pitch_px = 30});
  paint(image, design_9x7(), {.roll_deg = 33, .missing = {}, .rings = {}, .middle = {480, 330}, .pitch_px = 27});
  const auto grid = find_dot_grid(image, design_9x7());
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().code, ErrorCode::kTargetAmbiguous) << grid.error().message();
}

TEST(DotGrid, an_empty_image_has_no_target) {
  EXPECT_EQ(find_dot_grid(Map<float>(640, 480, 30.0F), design_9x7()).error().code, ErrorCode::kTargetNotFound);
}

TEST(Target, bad_files_are_refused_with_the_key) {
  const auto refused = [](const char* text, const char* key) {
    const auto t = parse_target(text);
    ASSERT_FALSE(t) << text;
    EXPECT_EQ(t.error().code, ErrorCode::kTargetFile);
    EXPECT_THAT(t.error().detail, testing::HasSubstr(key));
  };
  refused("[]", "object");
  refused(R"({"cols": 9})", "type");
  refused(R"({"type": "circle_grid", "cols": 9.5, "rows": 7, "pitch_mm": 2, "radius_mm": 0.3})", "cols");
  refused(R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": -2, "radius_mm": 0.3})", "pitch_mm");
  refused(R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": 2, "radius_mm": 1.3})", "radius_mm");
  refused(R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": 2, "radius_mm": 0.3, "marks": [[9, 0]]})",
          "marks");
  refused(R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": 2, "pitch_mm": 3, "radius_mm": 0.3})",
          "'pitch_mm' is written twice");
}

}  // namespace
}  // namespace enamel::calib
