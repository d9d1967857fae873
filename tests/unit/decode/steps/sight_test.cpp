#include "pipeline/decode/steps/sight.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "pipeline/types/sight_votes.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kWidth = 640, kHeight = 480;
constexpr float kBlack_dn = 4, kFringe_px = 27;

/// What a pixel returns: light above black, contrast of the fringes, other light.
struct Light {
  float surface_dn = 60, contrast = 0.85F, other_dn = 0;
};

/// Frames' first solution as light makes it, without noise: the gates on noise are those of its model.
class Picture {
 public:
  explicit Picture(const std::function<Light(int, int)>& light) {
    maps.resize(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) put(u, v, light(u, v));
    }
  }
  [[nodiscard]] Sight look() const {
    NoiseModel noise;
    noise.black_dn = kBlack_dn, noise.slope_dn = 1.0F / 40, noise.floor_dn2 = 0.1F;
    return look_at(noise, maps);
  }
  PhaseMaps maps;

 private:
  void put(int u, int v, const Light& light) {
    const float phase = 6.2831853F * static_cast<float>(u) / kFringe_px;
    const float b = light.contrast * light.surface_dn, a = light.surface_dn + light.other_dn;
    maps.mean_dn(u, v) = kBlack_dn + a;
    maps.cosine_dn(u, v) = b * std::cos(phase), maps.sine_dn(u, v) = b * std::sin(phase);
    maps.modulation_dn(u, v) = b;
    const bool saturated = a + b > 243, dark = a + b < 2;
    maps.reject(u, v) = saturated ? PixelReject::kSaturated : dark ? PixelReject::kDark : PixelReject::kNone;
  }
};

/// Bright crowns and darker gum, tooth by tooth, lit less at the sides.
float relief(int u, int v) {
  const float tooth = std::abs(v - kHeight / 2) < 150 ? 1.0F : 0.45F;
  return tooth * (0.75F + 0.25F * std::cos(0.02F * static_cast<float>(u)));
}

TEST(Sight, plaster_and_teeth_are_in_nobodys_way) {
  EXPECT_EQ(Picture([](int u, int v) { return Light{90 * relief(u, v), 0.85F}; }).look().trouble, SightTrouble::kNone);
  const Sight teeth = Picture([](int u, int v) {
                        return Light{110 * relief(u, v), relief(u, v) > 0.5F ? 0.25F : 0.29F};
                      }).look();
  EXPECT_EQ(teeth.trouble, SightTrouble::kNone);
  EXPECT_EQ(teeth.veil_dn, 0);
}

TEST(Sight, fog_is_a_veil_over_bright_and_dark_alike) {
  for (const float veil : {15.0F, 30.0F}) {
    const Sight s = Picture([&](int u, int v) { return Light{60 * relief(u, v), 0.8F, veil}; }).look();
    EXPECT_EQ(s.trouble, SightTrouble::kFog) << veil;
    EXPECT_NEAR(s.veil_dn, veil, 0.1F * veil);
  }
  EXPECT_EQ(Picture([](int u, int v) {
              return Light{60 * relief(u, v), 0.8F, 1};
            })
                .look()
                .trouble,
            SightTrouble::kNone);
}

TEST(Sight, a_lamp_lights_what_the_projector_does_not) {
  const auto shadowed = [](int u, int v) {
    const bool shade = u > 400 && u < 480;
    return Light{shade ? 0.0F : 70 * relief(u, v), 0.8F, 20 * relief(u + 150, v)};
  };
  EXPECT_EQ(Picture(shadowed).look().trouble, SightTrouble::kLamp);
  const auto dark = [&](int u, int v) {
    Light light = shadowed(u, v);
    light.other_dn = 0;
    return light;
  };
  EXPECT_EQ(Picture(dark).look().trouble, SightTrouble::kNone) << "control: a shadow";
}

TEST(Sight, a_lamp_that_swings_makes_frames_differ) {
  Picture picture([](int u, int v) { return Light{70 * relief(u, v), 0.7F}; });
  for (float& c : picture.maps.cosine_dn.pixels()) c += 4;
  EXPECT_EQ(picture.look().trouble, SightTrouble::kLamp);
}

TEST(Sight, metal_is_the_large_place_that_keeps_its_contrast) {
  const auto crown = [](float reach_px) {
    return [reach_px](int u, int v) {
      const bool metal = std::hypot(static_cast<float>(u - 420), static_cast<float>(v - 200)) < reach_px;
      return metal ? Light{9, 0.85F} : Light{100 * relief(u, v), 0.26F};
    };
  };
  const Sight s = Picture(crown(130)).look();
  EXPECT_EQ(s.trouble, SightTrouble::kMetal);
  EXPECT_NEAR(s.x_px, 420, 20);
  EXPECT_NEAR(s.y_px, 200, 20);
  EXPECT_EQ(Picture(crown(40)).look().trouble, SightTrouble::kNone) << "control: a glint";
}

TEST(Sight, glare_is_told_with_its_place) {
  const auto wet = [](int u, int v) {
    const bool drop = std::hypot(static_cast<float>(u - 200), static_cast<float>(v - 260)) < 22;
    return drop ? Light{250, 0.5F} : Light{100 * relief(u, v), 0.26F};
  };
  const Sight s = Picture(wet).look();
  EXPECT_EQ(s.trouble, SightTrouble::kGlare);
  EXPECT_NEAR(s.x_px, 200, 32);
  EXPECT_NEAR(s.y_px, 260, 32);
  EXPECT_GT(s.spoilt_share, 0.002F);
}

TEST(Sight, no_picture_at_all_is_no_trouble) {
  EXPECT_EQ(Picture([](int, int) { return Light{0, 0}; }).look().trouble, SightTrouble::kNone);
}

TEST(SightVotes, words_do_not_flicker) {
  SightVotes votes;
  const Sight none, glare{.trouble = SightTrouble::kGlare, .x_px = 10, .y_px = 20};
  EXPECT_EQ(votes.add(glare).trouble, SightTrouble::kNone) << "one burst";
  for (int k = 0; k < 3; ++k) static_cast<void>(votes.add(k % 2 == 0 ? none : glare));
  static_cast<void>(votes.add(glare));
  EXPECT_EQ(votes.add(glare).trouble, SightTrouble::kGlare) << "four of the last eight";
  const Sight kept = votes.add(none);
  EXPECT_EQ(kept.trouble, SightTrouble::kGlare);
  EXPECT_EQ(kept.x_px, 10) << "where it was seen last";
  for (int k = 0; k < 8; ++k) static_cast<void>(votes.add(none));
  EXPECT_EQ(votes.add(none).trouble, SightTrouble::kNone);
}

}  // namespace
}  // namespace enamel::pipeline
