#include "pipeline/decode/steps/translucency.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pipeline/decode/phase/poly_trig.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kDepth_mm = 48, kBlack_dn = 4, kLight_dn = 60;

/// A facing plane whose fringes have `ratio` of the projected contrast and whose phase is that of `depth_mm`.
class Plane {
 public:
  explicit Plane(float ratio, float depth_mm = kDepth_mm, const ApparentDepthField& field = {})
      : rig_(test::cropped_rig(kWidth, kHeight)), rays_(RayDepth::bake(rig_, *rig_.depth_range).value()) {
    optics_ = {static_cast<float>(rig_.patterns.amplitude / rig_.patterns.mean),
               static_cast<float>(rig_.patterns.period_px / rig_.projector.fx), field};
    phase_.resize(kWidth, kHeight);
    wraps_ = Map<std::int16_t>(kWidth, kHeight);
    for (std::size_t i = 0; i < phase_.phase_rad.size(); ++i) {
      float at = rays_.phase_mid_rad[i];
      for (int k = 0; k < 6; ++k) at += (1 / depth_mm - rays_.inverse_depth(i, at)) / rays_.inverse_depth_slope(i, at);
      wraps_[i] = static_cast<std::int16_t>(std::floor(at / kTwoPiF + 0.5F));
      phase_.phase_rad[i] = at - kTwoPiF * static_cast<float>(wraps_[i]);
      phase_.mean_dn[i] = kBlack_dn + kLight_dn;
      phase_.modulation_dn[i] = ratio * optics_.contrast * kLight_dn;
      phase_.sigma_rad[i] = 0.02F;
      phase_.reject[i] = PixelReject::kNone;
    }
  }
  void undo(TranslucencyConfig config = {}) {
    undo_translucency({rays_, optics_, kBlack_dn}, config, {phase_, wraps_, {}}, sight, phase_);
  }
  /// Of a pixel, um beyond the plane.
  [[nodiscard]] double off_um(int u = kWidth / 2, int v = kHeight / 2) const {
    const std::size_t i = phase_.phase_rad.index(u, v);
    const float at = phase_.phase_rad[i] + kTwoPiF * static_cast<float>(wraps_[i]);
    return 1e3 * (1 / static_cast<double>(rays_.inverse_depth(i, at)) - static_cast<double>(kDepth_mm));
  }
  [[nodiscard]] float period_mm() const { return optics_.period_per_mm * kDepth_mm; }
  [[nodiscard]] PhaseMaps& maps() { return phase_; }

  Sight sight;

 private:
  calib::Rig rig_;
  RayDepth rays_;
  PatternOptics optics_;
  PhaseMaps phase_;
  Map<std::int16_t> wraps_;
};

/// A medium of the two shares: what its surface returns and, from depth_mm with contrast m, its inside.
struct Medium {
  double surface, m, depth_mm;
  [[nodiscard]] double ratio() const { return surface + (1 - surface) * m; }
  [[nodiscard]] double apparent_mm() const { return (1 - surface) * m * depth_mm / ratio(); }
};

TEST(Translucency, takes_off_what_enamel_adds_whatever_its_surface_returns) {
  for (const double surface : {0.05, 0.1, 0.2, 0.35}) {
    // Monte Carlo of enamel at 0.72 mm, between its values at 0.5 and 1 mm.
    const Medium enamel{surface, 0.113, 0.091};
    const auto depth_mm = static_cast<float>(static_cast<double>(kDepth_mm) + enamel.apparent_mm());
    Plane plane(static_cast<float>(0.92 * enamel.ratio()), depth_mm);
    EXPECT_NEAR(plane.period_mm(), 0.72, 0.03);
    EXPECT_NEAR(plane.off_um(), 1e3 * enamel.apparent_mm(), 1) << "before";
    plane.undo();
    EXPECT_NEAR(plane.off_um(), 0, 0.2 * 1e3 * enamel.apparent_mm()) << surface;
    EXPECT_FLOAT_EQ(plane.sight.translucent_share, 1);
    EXPECT_NEAR(1e3 * static_cast<double>(plane.sight.apparent_depth_mm), 1e3 * enamel.apparent_mm(), 6);
  }
}

TEST(Translucency, goes_by_what_the_probe_was_calibrated_on) {
  const std::array<std::array<double, 3>, 3> shares{{{0.8, 0.9, 1.0}, {1.1, 1.2, 1.3}, {1.4, 1.5, 1.6}}};
  Plane enamel(0.25F), calibrated(0.25F, kDepth_mm, ApparentDepthField(shares, kWidth, kHeight));
  enamel.undo(), calibrated.undo();
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t u = 0; u < 3; ++u) {
      const int x = static_cast<int>(u) * (kWidth - 1) / 2, y = static_cast<int>(v) * (kHeight - 1) / 2;
      EXPECT_NEAR(calibrated.off_um(x, y), shares[v][u] * enamel.off_um(x, y),
                  0.01 * std::abs(enamel.off_um(x, y)) + 0.5);
    }
  }
}

TEST(Translucency, leaves_plaster_alone_to_the_bit) {
  Plane plane(0.85F);
  const Map<float> before = plane.maps().phase_rad, sigma = plane.maps().sigma_rad;
  plane.undo();
  EXPECT_TRUE(std::ranges::equal(plane.maps().phase_rad.pixels(), before.pixels()));
  EXPECT_TRUE(std::ranges::equal(plane.maps().sigma_rad.pixels(), sigma.pixels()));
  EXPECT_EQ(plane.sight.apparent_depth_mm, 0);
}

TEST(Translucency, a_few_pixels_of_low_contrast_are_edges_and_stay) {
  Plane plane(0.85F);
  for (int v = 0; v < 10; ++v) {
    for (int u = 0; u < kWidth; ++u) plane.maps().modulation_dn(u, v) = 10;
  }
  const Map<float> before = plane.maps().phase_rad;
  plane.undo();
  EXPECT_TRUE(std::ranges::equal(plane.maps().phase_rad.pixels(), before.pixels()));
}

TEST(Translucency, is_told_where_it_is_not_undone) {
  Plane plane(0.25F);
  plane.undo({.correct = false});
  EXPECT_NEAR(plane.off_um(), 0, 0.5);
  EXPECT_GT(plane.sight.apparent_depth_mm, 0.01F);
}

TEST(Translucency, a_projector_that_is_not_linear_shows_more_contrast) {
  // level^gamma over a full cosine has h2 = (gamma - 1)/(gamma + 2), h3 = h2 (gamma - 2)/(gamma + 3) and the contrast
  // 2 gamma/(gamma + 1) (Liu et al. 2010).
  for (const double gamma : {1.4, 1.8, 2.2}) {
    Waveform wave;
    wave.harmonic[0] = (gamma - 1) / (gamma + 2);
    wave.harmonic[1] = wave.harmonic[0] * (gamma - 2) / (gamma + 3);
    EXPECT_NEAR(static_cast<double>(seen_through(wave, {1, 0.015F}).contrast), 2 * gamma / (gamma + 1), 0.04) << gamma;
  }
  EXPECT_EQ(seen_through({}, {0.93F, 0.015F}).contrast, 0.93F);
}

TEST(Translucency, its_uncertainty_joins_sigma) {
  Plane plane(0.25F);
  plane.undo();
  EXPECT_GT(plane.maps().sigma_rad(kWidth / 2, kHeight / 2), 0.021F);
}

TEST(Translucency, a_veil_of_other_light_is_no_light_from_inside) {
  Plane plane(0.85F);
  for (float& mean : plane.maps().mean_dn.pixels()) mean += kLight_dn;  // half of it has no fringes
  Plane unknown = plane;
  unknown.undo();
  EXPECT_GT(unknown.sight.apparent_depth_mm, 0) << "control: contrast alone cannot tell";
  plane.sight.veil_dn = kLight_dn;
  plane.undo();
  EXPECT_EQ(plane.sight.apparent_depth_mm, 0);
}

}  // namespace
}  // namespace enamel::pipeline
