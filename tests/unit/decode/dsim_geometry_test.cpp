// Figures of docs/notes/design-figures.md §0, §4 and §5 made anew: sensitivity, Laplacian noise, polynomials of depth.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pipeline/decode/unwrap/links.hpp"
#include "tests/unit/decode/dsim.hpp"

namespace enamel::pipeline {
namespace {

using namespace test::dsim;  // NOLINT: the vocabulary of these tests

constexpr double kAngle_rad = 12 * kPi / 180, kNear_mm = 40, kFar_mm = 56, kMiddle_mm = 48;

TEST(DsimGeometry, sensitivity_and_shot_limit_of_the_reference_design) {
  struct Row {
    double period_mm, mm_per_rad, jump_mm;
    int orders;
    double plaster_um, tooth_um;
  };
  for (const Row& row : {Row{0.5, 0.374, 2.35, 7, 5.7, 26}, Row{0.75, 0.562, 3.53, 5, 8.5, 40},
                         Row{1, 0.749, 4.70, 4, 11, 53}, Row{2, 1.50, 9.4, 2, 23, 105}}) {
    const double per_rad = row.period_mm / (2 * kPi * std::tan(kAngle_rad)),
                 jump = row.period_mm / std::tan(kAngle_rad);
    EXPECT_NEAR(per_rad, row.mm_per_rad, 0.01);
    EXPECT_NEAR(jump, row.jump_mm, 0.02);
    EXPECT_EQ(static_cast<int>((kFar_mm - kNear_mm) / jump) + 1, row.orders);
    const double sigma_rad = std::sqrt(2 / (4 * 4500.0));  // contrast 1, 45 % of 10 ke-
    EXPECT_NEAR(1e3 * per_rad * sigma_rad / 0.7, row.plaster_um, 0.5);
    EXPECT_NEAR(1e3 * per_rad * sigma_rad / 0.15, row.tooth_um, 1.5);
  }
  const double rounding_e = 10000.0 / 1024 / std::sqrt(12.0);
  EXPECT_LT(std::sqrt((4500 + 25 + rounding_e * rounding_e) / 4500) - 1, 0.01);
}

/// Noise of the Laplacian is sqrt(20) sigma: three times that is what links.hpp calls clean.
TEST(DsimGeometry, laplacian_of_noise) {
  constexpr int kSize = 400;
  constexpr double kSigma_rad = 0.05;
  test::Normals normal(4);
  Map<double> phase(kSize, kSize);
  for (double& p : phase.pixels()) p = kSigma_rad * normal();
  double squares = 0, n = 0;
  for (int v = 1; v + 1 < kSize; ++v) {
    for (int u = 1; u + 1 < kSize; ++u) {
      const double l = phase(u + 1, v) + phase(u - 1, v) + phase(u, v + 1) + phase(u, v - 1) - 4 * phase(u, v);
      squares += l * l, n += 1;
    }
  }
  EXPECT_NEAR(std::sqrt(squares / n) / kSigma_rad, std::sqrt(20.0), 0.03);
}

TEST(DsimGeometry, quality_calls_noise_clean_and_a_jump_not) {
  PhaseMaps maps;
  maps.resize(64, 8);
  test::Normals normal(6);
  for (int v = 0; v < 8; ++v) {
    for (int u = 0; u < 64; ++u) {
      const std::size_t i = maps.phase_rad.index(u, v);
      maps.sigma_rad[i] = 0.03F, maps.modulation_dn[i] = 50, maps.reject[i] = PixelReject::kNone;
      maps.phase_rad[i] = static_cast<float>(wrap(0.2 * u + 0.03 * normal() + (u < 32 ? 0 : 1.0)));
    }
  }
  const std::vector<float> carrier(maps.phase_rad.size(), 0.0F);
  LinkMaps links;
  compute_links(maps, {carrier.data(), 0.4F, 0.4F}, {}, links);
  int clean = 0;
  for (int u = 4; u < 28; ++u) clean += links.quality(u, 4) >= kCleanQuality ? 1 : 0;
  EXPECT_GE(clean, 22);  // 0.3 % of noise lies beyond three sigma
  EXPECT_LT(links.quality(31, 4), kCleanQuality);
  EXPECT_LT(links.quality(32, 4), kCleanQuality);
}

/// Worst error, um, over the depth range of polynomials of a degree, fitted to z and to 1/z of a pure pinhole.
struct Fit {
  double of_depth_um = 0, of_inverse_um = 0;
};

Fit polynomial(int degree) {
  Fit out;
  const double base_mm = kMiddle_mm * std::tan(kAngle_rad);
  for (int ray = -3; ray <= 3; ++ray) {
    constexpr int kNodes = 400;
    Eigen::VectorXd z(kNodes), column(kNodes);
    for (int i = 0; i < kNodes; ++i) {
      z[i] = kNear_mm + (kFar_mm - kNear_mm) * i / (kNodes - 1);
      const double x = 0.06 * ray * z[i] - base_mm;
      column[i] = (std::cos(kAngle_rad) * x + std::sin(kAngle_rad) * z[i]) /
                  (std::cos(kAngle_rad) * z[i] - std::sin(kAngle_rad) * x);
    }
    const Eigen::VectorXd t =
        (2 * (column.array() - column.minCoeff()) / (column.maxCoeff() - column.minCoeff()) - 1).matrix();
    Eigen::MatrixXd basis(kNodes, degree + 1);
    for (int k = 0; k <= degree; ++k) basis.col(k) = (k * t.array().max(-1).min(1).acos()).cos().matrix();
    const auto solver = basis.colPivHouseholderQr();
    const Eigen::VectorXd inverse = z.cwiseInverse();
    const Eigen::VectorXd depth = basis * solver.solve(z),
                          from_inverse = (basis * solver.solve(inverse)).cwiseInverse();
    out.of_depth_um = std::max(out.of_depth_um, 1e3 * (depth - z).cwiseAbs().maxCoeff());
    out.of_inverse_um = std::max(out.of_inverse_um, 1e3 * (from_inverse - z).cwiseAbs().maxCoeff());
  }
  return out;
}

TEST(DsimGeometry, polynomials_of_inverse_depth_beat_those_of_depth) {
  struct Row {
    int degree;
    double worst_um;
  };
  // Where the worst lies depends on the field's edge and on the nodes: the design's figures within a sixth.
  for (const Row& row : {Row{2, 94}, Row{3, 9.1}, Row{4, 0.85}, Row{5, 0.08}}) {
    const Fit fit = polynomial(row.degree);
    EXPECT_NEAR(fit.of_depth_um, row.worst_um, row.worst_um / 3) << row.degree;
    EXPECT_LT(fit.of_inverse_um, 0.01 * fit.of_depth_um) << row.degree;
  }
  EXPECT_LT(polynomial(3).of_inverse_um, 0.002);
}

/// Iteration project -> undistort: the error shrinks by 1/(distortion gradient), 50 at 2 %.
TEST(DsimGeometry, undistortion_contracts_fiftyfold) {
  calib::LensValues lens = calib::parse_rig(test::kRigText)->camera;
  lens.dist = {-0.2, 0, 0, 0, 0};
  const calib::PlanePoint truth{0.16, 0.09};  // gradient of the distortion there: 0.2 (3 x^2 + y^2), about 0.017
  const calib::PlanePoint seen = calib::distort(lens, truth);
  calib::PlanePoint p = seen;
  double before = std::hypot(p.x - truth.x, p.y - truth.y);
  for (int pass = 0; pass < 3; ++pass) {
    const calib::PlanePoint d = calib::distort(lens, p);
    p = {p.x + seen.x - d.x, p.y + seen.y - d.y};
    const double after = std::hypot(p.x - truth.x, p.y - truth.y);
    EXPECT_GT(before / after, 40);
    before = after;
  }
}

}  // namespace
}  // namespace enamel::pipeline
