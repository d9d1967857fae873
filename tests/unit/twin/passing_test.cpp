// What comes and goes while the probe scans: bodies that move by themselves, fog on the window, the lamp.
#include <algorithm>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/movers/mover_motion.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary
using Light = std::array<std::vector<float>, 4>;

constexpr std::uint64_t kMiddle = 7;

/// A stand before a plane, a finger in the view during all fifteen bursts but the first and last few.
SceneConfig finger_scene() {
  SceneConfig s = plane_scene();
  s.effects = ideal();
  s.views[0].bursts = 15;
  s.timing.burst_rate_hz = 15;
  MoverConfig finger;
  finger.kind = MoverKind::kFinger;
  finger.share = 1;
  finger.reach_mm = 2;
  s.movers = {finger};
  return s;
}

struct Burst {
  Light light;
  TruthMaps maps;
  std::vector<BurstTruth::Mover> movers;
};

Burst middle_burst(const SceneConfig& scene) {
  const auto source = source_of(scene, small_rig());
  Burst out;
  for (std::uint64_t n = 0; n <= kMiddle; ++n) EXPECT_TRUE(source->next());
  out.light = source->mean_light(kMiddle);
  out.maps = source->truth().maps;
  out.movers = source->truth().movers;
  return out;
}

bool same(const Light& a, const Light& b, std::size_t i) {
  return std::ranges::all_of(std::array{0U, 1U, 2U, 3U}, [&](unsigned k) { return a[k][i] == b[k][i]; });
}

/// Whether a body shows in the pixel or beside it.
bool touched(const TruthMaps& maps, std::size_t i, std::size_t width) {
  for (const std::ptrdiff_t dy : {-1, 0, 1}) {
    for (const std::ptrdiff_t dx : {-1, 0, 1}) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) + dx + dy * static_cast<std::ptrdiff_t>(width);
      if (at >= 0 && at < std::ssize(maps.mover) && maps.mover[static_cast<std::size_t>(at)] != 0) return true;
    }
  }
  return false;
}

TEST(TwinMovers, one_switched_off_leaves_every_bit) {
  SceneConfig scene = finger_scene();
  scene.effects.movers = false;
  const Burst off = middle_burst(scene);
  scene.movers.clear();
  const Burst none = middle_burst(scene);
  EXPECT_EQ(off.light, none.light);
  EXPECT_EQ(off.maps.depth, none.maps.depth);
  EXPECT_TRUE(off.movers.empty());
  EXPECT_NE(middle_burst(finger_scene()).light, none.light);  // control
}

TEST(TwinMovers, one_in_view_changes_its_own_pixels_only) {
  const Burst with = middle_burst(finger_scene());
  SceneConfig bare = finger_scene();
  bare.movers.clear();
  const Burst without = middle_burst(bare);
  const auto width = static_cast<std::size_t>(small_rig().camera.width);
  std::size_t its = 0, changed = 0, wrong = 0;
  for (std::size_t i = 0; i < with.maps.mover.size(); ++i) {
    if (with.maps.mover[i] != 0) {
      ++its;
      if (!same(with.light, without.light, i)) ++changed;
      EXPECT_LT(with.maps.depth[i], without.maps.depth[i]);
    } else if (!touched(with.maps, i, width) && !same(with.light, without.light, i)) {
      ++wrong;
    }
  }
  EXPECT_GT(its, with.maps.mover.size() / 20);
  EXPECT_LT(its, with.maps.mover.size() * 9 / 10);
  EXPECT_GT(changed, its * 99 / 100);
  EXPECT_EQ(wrong, 0U);
  ASSERT_EQ(with.movers.size(), 1U);
  EXPECT_EQ(with.movers[0].seen_px, its);
}

TEST(TwinMovers, its_shadow_falls_on_what_lies_behind) {
  SceneConfig scene = finger_scene();
  std::size_t darker = 0;
  // Light comes along the finger, more or less: as the seed has it lie, the shadow is broad, or hidden behind it.
  for (const std::uint64_t seed : {4U, 5U, 6U}) {
    scene.seed = seed;
    scene.movers[0].depth_mm = 10;
    scene.effects.shadow = false;
    const Burst light = middle_burst(scene);
    scene.effects.shadow = true;
    const Burst shade = middle_burst(scene);
    for (std::size_t i = 0; i < shade.maps.mover.size(); ++i) {
      if (shade.maps.mover[i] == 0 && shade.light[0][i] < 0.1F * light.light[0][i]) ++darker;
    }
  }
  EXPECT_GT(darker, std::size_t{500});
}

TEST(TwinMovers, it_moves_within_a_burst_before_a_probe_at_rest) {
  SceneConfig scene = finger_scene();
  scene.movers[0].speed_mm_s = 30;
  scene.movers[0].depth_mm = 8;
  const Burst still = middle_burst(scene);
  scene.effects.motion = true;
  const Burst moving = middle_burst(scene);
  const auto width = static_cast<std::size_t>(small_rig().camera.width);
  std::size_t own = 0, other = 0;
  for (std::size_t i = 0; i < still.maps.mover.size(); ++i) {
    if (same(still.light, moving.light, i)) continue;
    ++(touched(still.maps, i, width) || touched(moving.maps, i, width) ? own : other);
  }
  EXPECT_GT(own, std::size_t{500});
  EXPECT_LT(other, own / 10);  // where it was at the ends of the burst
  scene.movers.clear();        // control: nothing else moves there
  const Burst rest = middle_burst(scene);
  scene.effects.motion = false;
  EXPECT_EQ(rest.light, middle_burst(scene).light);
}

/// Modulation over mean light of the four frames, mean over the body's pixels.
double contrast_of_body(const Burst& burst) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < burst.maps.mover.size(); ++i) {
    if (burst.maps.mover[i] == 0) continue;
    double least = burst.light[0][i], most = least, mean = 0;
    for (const std::vector<float>& frame : burst.light) {
      const auto light = static_cast<double>(frame[i]);
      least = std::min(least, light), most = std::max(most, light), mean += 0.25 * light;
    }
    if (mean <= 0) continue;
    sum += (most - least) / mean, count += 1;
  }
  return count > 0 ? sum / count : 0;
}

TEST(TwinMovers, a_tongue_beside_teeth_lets_light_in_and_a_glove_does_not) {
  SceneConfig scene = finger_scene();
  scene.effects.translucency = true;
  const double glove_before_plaster = contrast_of_body(middle_burst(scene));
  scene.look.material = static_cast<int>(MaterialId::kEnamel);
  EXPECT_NEAR(contrast_of_body(middle_burst(scene)), glove_before_plaster, 0.02);
  scene.movers[0].kind = MoverKind::kTongue;
  const double tongue = contrast_of_body(middle_burst(scene));
  scene.look.material = LookConfig::kPlaster;
  const double plaster_tongue = contrast_of_body(middle_burst(scene));  // control
  EXPECT_GT(plaster_tongue, 0.5);
  EXPECT_LT(tongue, 0.6 * plaster_tongue);
}

TEST(TwinMovers, it_is_there_for_the_share_asked_for) {
  constexpr double kScanS = 60, kStepS = 0.01, kRampS = 0.6;
  LookedAt looked_at{[](double) { return Pose::Identity(); }, [](double) { return Vec3d::Zero(); }};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    MoverConfig config;
    config.share = 0.3;
    const MoverMotion motion(config, seed, kScanS, looked_at);
    double there_s = 0, ways_s = 0;
    bool before = false;
    for (double t = 0; t < kScanS; t += kStepS) {
      const bool now = motion.at(t).has_value();
      there_s += now ? kStepS : 0;
      ways_s += now && !before ? kRampS : 0;  // half of the ways in and out lie beyond the share
      before = now;
    }
    EXPECT_NEAR((there_s - ways_s) / kScanS, config.share, 0.02);
  }
}

TEST(TwinFog, it_takes_its_part_of_the_modulation) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  const Light clear = source_of(scene, small_rig())->mean_light(0);
  scene.fog = {.amount = 0.6, .veil = 0.5, .blur_px = 0};
  const Light foggy = source_of(scene, small_rig())->mean_light(0);
  for (std::size_t i = 0; i < clear[0].size(); i += 97) {
    const double before = static_cast<double>(clear[0][i] - clear[2][i]);
    EXPECT_NEAR(static_cast<double>(foggy[0][i] - foggy[2][i]), 0.4 * before, 1e-3);
    EXPECT_GT(foggy[0][i], 0.4F * clear[0][i]);  // the veil
  }
  scene.effects.fog = false;  // control
  EXPECT_EQ(source_of(scene, small_rig())->mean_light(0), clear);
}

TEST(TwinFog, it_comes_and_goes) {
  const FogConfig config{.amount = 0.8, .change_s = 2};
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    double least = 1, most = 0, step = 0;
    for (double t = 0; t < 60; t += 0.05) {
      const double now = fog_at(config, t, seed);
      least = std::min(least, now);
      most = std::max(most, now);
      step = std::max(step, std::abs(fog_at(config, t + 0.05, seed) - now));
    }
    EXPECT_LT(least, 0.1);
    EXPECT_GT(most, 0.7);
    EXPECT_LT(step, 0.1);  // slowly
  }
}

TEST(TwinLamp, it_adds_its_strength_by_the_cosine) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  const Light dark = source_of(scene, small_rig())->mean_light(0);
  scene.render.light.lamp = {.strength = 0.25, .direction = {0, 3, 4}};  // the plane's normal is z: cosine 0.8
  const Light lit = source_of(scene, small_rig())->mean_light(0);
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < dark[0].size(); i += 97) {
      EXPECT_NEAR(static_cast<double>(lit[k][i] - dark[k][i]), 0.25 * 0.8 * 0.8, 1e-5);
    }
  }
  scene.effects.lamp = false;  // control
  EXPECT_EQ(source_of(scene, small_rig())->mean_light(0), dark);
}

TEST(TwinLamp, flicker_differs_from_frame_to_frame) {
  SceneConfig scene = plane_scene();
  scene.effects = ideal();
  const Light dark = source_of(scene, small_rig())->mean_light(0);
  scene.render.light.lamp = {.strength = 0.25, .direction = {0, 0, 1}, .flicker = 0.5, .flicker_hz = 100};
  const auto source = source_of(scene, small_rig());
  const Light lit = source->mean_light(0);
  const std::size_t i = dark[0].size() / 2 + 80;
  std::array<double, 4> added{};
  for (std::size_t k = 0; k < 4; ++k) {
    added[k] = static_cast<double>(lit[k][i] - dark[k][i]);
    // The integral over the exposure, by steps.
    double sum = 0;
    constexpr int kSteps = 1000;
    const double start = 1e-9 * static_cast<double>(exposure_start_ns(scene.timing, 0, static_cast<int>(k)));
    for (int n = 0; n < kSteps; ++n) {
      const double t = start + 1e-3 * scene.timing.exposure_ms * (n + 0.5) / kSteps;
      sum += 1 + 0.5 * std::cos(2 * kPi * 100 * t);
    }
    EXPECT_NEAR(added[k], 0.25 * 0.8 * sum / kSteps, 1e-5);
  }
  EXPECT_GT(std::ranges::max(added) - std::ranges::min(added), 0.05);
}

std::string refusal_of(const std::string& text) {
  auto reader = ConfigReader::from_text("[object]\ntype='plane'\n[[path.view]]\n" + text, "test.toml");
  if (!reader) return reader.error().message();
  SceneConfig c;
  bind_scene(*reader, c);
  const auto done = reader->finish();
  return done ? "" : done.error().message();
}

TEST(TwinPassingKeys, what_makes_no_sense_is_refused) {
  EXPECT_EQ(refusal_of("[[mover]]\nkind='cotton'\nshare=0.2\n[fog]\namount=0.5\n[lamp]\nstrength=0.2\n"), "");
  EXPECT_NE(refusal_of("[[mover]]\nkind='dog'\n"), "");
  EXPECT_NE(refusal_of("[[mover]]\nshare=1.5\n"), "");
  EXPECT_NE(refusal_of("[lamp]\ndirection=[0, 0, 0]\n"), "");
  EXPECT_NE(refusal_of("[fog]\namont=0.5\n"), "");
}

}  // namespace
}  // namespace enamel::twin
