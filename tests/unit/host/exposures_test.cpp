// What further exposures of a stop bring: dark stone and coated stone of drawn kinds, rendered and decoded.
#include "host/desktop/exposures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/desktop/desktop_model.hpp"
#include "protocol/base/rng.hpp"
#include "tools/twin/app/burst_message.hpp"
#include "tools/twin/twin_source.hpp"

namespace enamel::host {
namespace {

using twin::MaterialId;

struct Seen {
  std::size_t px = 0;
  double median_mm = 0;  ///< of the distance from the truth, of what the first exposure shows as well
  double far_share = 0;  ///< of all pixels, those farther than kFar_mm
};

constexpr double kFar_mm = 0.15;  ///< derived: five sigmas of the worst pixel that is let pass, and no step of a fringe

/// One stop of the scene in a light of its own, burst by burst.
class Stop {
 public:
  explicit Stop(const twin::SceneConfig& scene) {
    auto made = twin::TwinSource::create(scene);
    EXPECT_TRUE(made) << made.error().message();
    source_ = std::move(*made);
    const auto first = source_->next();
    EXPECT_TRUE(first && *first);
    bursts.push_back(std::make_shared<proto::Burst>(twin::to_message(**first, 0)));
    truth_ = source_->truth().maps.depth;
  }
  void expose(std::uint32_t us) {
    fw::SimBurst burst = source_->planned(0);
    const double share = static_cast<double>(us) / burst.exposure_us;
    burst.burst_index = bursts.size();
    burst.frames = source_->frames(bursts.size(), source_->poses(0), share);
    burst.exposure_us = us;
    bursts.push_back(std::make_shared<proto::Burst>(twin::to_message(burst, 0)));
  }
  /// Of the first n bursts.
  [[nodiscard]] SurfacePatch patch(std::size_t n) const {
    auto model = DesktopModel::make(source_->rig(), {}, {}, 2);
    EXPECT_TRUE(model) << model.error().message();
    StopBursts stop;
    stop.bursts.assign(bursts.begin(), bursts.begin() + static_cast<std::ptrdiff_t>(n));
    static_cast<void>(model->add(stop));
    return model->patch_of(0);
  }
  [[nodiscard]] Seen judge(const SurfacePatch& patch, const SurfacePatch& common) const {
    Seen out;
    std::vector<double> errors;
    std::size_t far = 0;
    for (std::size_t i = 0; i < patch.depth_mm.size(); ++i) {
      if (std::isnan(patch.depth_mm[i])) continue;
      ++out.px;
      const double error = std::abs(static_cast<double>(patch.depth_mm[i]) - static_cast<double>(truth_[i]));
      far += error < kFar_mm ? 0U : 1U;  // NaN: nothing is there
      if (!std::isnan(common.depth_mm[i])) errors.push_back(error);
    }
    if (errors.empty()) return out;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::ranges::nth_element(errors, middle);
    out.median_mm = *middle;
    out.far_share = static_cast<double>(far) / static_cast<double>(out.px);
    return out;
  }

  std::vector<std::shared_ptr<const proto::Burst>> bursts;

 private:
  std::unique_ptr<twin::TwinSource> source_;
  std::vector<float> truth_;
};

/// The model as a whole of one kind.
twin::SceneConfig stone(std::uint64_t seed, MaterialId material) {
  auto scene = twin::load_scene(std::string(ENAMEL_SOURCE_DIR) + "/config/scenes/desktop_stone.toml");
  EXPECT_TRUE(scene) << scene.error().message();
  scene->seed = seed;
  scene->jaw.from_mm = 24;
  scene->jaw.to_mm = 46;
  scene->render.grid = 1;
  scene->look.material = static_cast<int>(material);
  scene->look.mouth = {};
  return *scene;
}

void expect_more_and_nothing_worse(const Stop& stop, double least_gain) {
  const SurfacePatch one = stop.patch(1), all = stop.patch(stop.bursts.size());
  ASSERT_FALSE(one.depth_mm.empty());
  ASSERT_FALSE(all.depth_mm.empty());
  const Seen before = stop.judge(one, one), after = stop.judge(all, one);
  EXPECT_GT(static_cast<double>(after.px), (1 + least_gain) * static_cast<double>(before.px));
  EXPECT_LE(after.median_mm, 1.02 * before.median_mm);
  EXPECT_LE(after.far_share, before.far_share + 0.002);
  std::size_t lost = 0;
  for (std::size_t i = 0; i < one.depth_mm.size(); ++i)
    lost += !std::isnan(one.depth_mm[i]) && std::isnan(all.depth_mm[i]) ? 1U : 0U;
  EXPECT_LE(static_cast<double>(lost), 0.01 * static_cast<double>(before.px)) << "seen by one exposure, not by all";
}

/// Of what glares in the first burst and has no depth there, the share that has one by all.
double share_healed(const Stop& stop) {
  constexpr int kClipped = 247;  // of 255
  const SurfacePatch one = stop.patch(1), all = stop.patch(stop.bursts.size());
  std::size_t blind = 0, healed = 0;
  for (std::size_t i = 0; i < one.depth_mm.size(); ++i) {
    bool clips = false;
    for (int k = 0; k < 4; ++k) clips = clips || proto::frame_bytes(*stop.bursts[0], k)[i] >= kClipped;
    if (!clips || !std::isnan(one.depth_mm[i])) continue;
    ++blind;
    healed += std::isnan(all.depth_mm[i]) ? 0U : 1U;
  }
  EXPECT_GT(blind, 300U) << "nothing glares, and nothing can be healed";
  return blind == 0 ? 0 : static_cast<double>(healed) / static_cast<double>(blind);
}

TEST(Exposures, dark_dies_need_a_longer_one_and_gain_by_it) {
  Rng rng(11, 0, 0);
  twin::SceneConfig scene = stone(3, MaterialId::kDark);
  scene.look.materials[twin::index_of(MaterialId::kDark)].albedo = rng.uniform(0.03, 0.06);
  Stop stop(scene);
  const auto further = further_exposures(*stop.bursts[0], {});
  ASSERT_EQ(further.size(), 1U);
  EXPECT_GT(further[0], stop.bursts[0]->meta[0].exposure_us);
  stop.expose(further[0]);
  EXPECT_TRUE(is_exposed(*stop.bursts[1], further[0]));
  EXPECT_FALSE(is_exposed(*stop.bursts[0], further[0]));
  expect_more_and_nothing_worse(stop, 0.3);
}

TEST(Exposures, coated_stone_in_bright_light_needs_a_shorter_one_and_gains_by_it) {
  Rng rng(12, 0, 0);
  twin::SceneConfig scene = stone(4, MaterialId::kCeramic);
  auto& coated = scene.look.materials[twin::index_of(MaterialId::kCeramic)];
  coated.roughness = rng.uniform(0.1, 0.2);
  coated.specular = rng.uniform(1.2, 1.8);
  scene.timing.exposure_ms = 3.7;  // as dark dies need it: no longer one fits
  scene.render.light.reference_fraction *= 2;
  Stop stop(scene);
  const auto further = further_exposures(*stop.bursts[0], {});
  ASSERT_EQ(further.size(), 1U);
  EXPECT_LT(further[0], stop.bursts[0]->meta[0].exposure_us);
  stop.expose(further[0]);
  expect_more_and_nothing_worse(stop, 0.005);
  EXPECT_GT(share_healed(stop), 0.6);
}

TEST(Exposures, plain_stone_needs_no_other) {
  Rng rng(13, 0, 0);
  twin::SceneConfig scene = stone(5, MaterialId::kPlaster);
  scene.timing.exposure_ms = rng.uniform(0.8, 1.1);
  const Stop stop(scene);
  EXPECT_TRUE(further_exposures(*stop.bursts[0], {}).empty());
  const auto own_us = stop.bursts[0]->meta[0].exposure_us;
  EXPECT_EQ(further_exposures(*stop.bursts[0], {.exposures = 2}), (std::vector<std::uint32_t>{(own_us + 2) / 4}));
  EXPECT_EQ(further_exposures(*stop.bursts[0], {.exposures = 3}).size(), 2U);
  EXPECT_TRUE(further_exposures(*stop.bursts[0], {.exposures = 1}).empty());
}

}  // namespace
}  // namespace enamel::host
