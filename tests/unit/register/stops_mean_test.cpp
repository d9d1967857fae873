// Several bursts of one stop as one patch, and the picture made of one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "pipeline/decode/triangulate/mean_patch.hpp"
#include "pipeline/stages/live_image.hpp"
#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr double kBurstSigma_mm = 0.0085;

struct Bursts {
  calib::Rig rig = ts::test_rig(8);
  RayDepth rays;
  SurfacePatch exact;
  std::vector<SurfacePatch> noisy;

  explicit Bursts(std::size_t count, std::uint64_t seed) {
    rays.width = rig.camera.width, rays.height = rig.camera.height;
    rays.rays = calib::make_ray_table(rig.camera);
    const ts::SyntheticSurface surface(seed);
    exact = ts::make_patch(surface, rig.camera, ts::looking_down(0, 0), {0, 0, 1});
    for (std::size_t k = 0; k < count; ++k)
      noisy.push_back(ts::make_patch(surface, rig.camera, ts::looking_down(0, 0), {kBurstSigma_mm, 0, 100 * seed + k}));
  }
  [[nodiscard]] SurfacePatch mean(const MeanConfig& config = {}) const { return mean_patch(noisy, rays, {}, config); }
};

double rms_error_mm(const SurfacePatch& found, const SurfacePatch& exact) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < found.depth_mm.size(); ++i) {
    if (std::isnan(found.depth_mm[i]) || std::isnan(exact.depth_mm[i])) continue;
    const double e = static_cast<double>(found.depth_mm[i]) - static_cast<double>(exact.depth_mm[i]);
    sum += e * e;
    ++n;
  }
  return std::sqrt(sum / static_cast<double>(n));
}

TEST(MeanPatch, has_the_sigma_and_the_error_of_a_mean) {
  for (const std::size_t count : {2U, 3U, 8U}) {
    const Bursts b(count, 40 + count);
    const SurfacePatch mean = b.mean();
    ASSERT_GT(mean.valid_px, 4000U);
    const double expected = kBurstSigma_mm / std::sqrt(static_cast<double>(count));
    EXPECT_NEAR(static_cast<double>(mean.sigma_mm[mean.sigma_mm.index(40, 30)]), expected, 0.02 * expected);
    // derived: the rms of 4000 and more draws is known to 1.2 %, and the gate cuts 1e-4 of them
    EXPECT_NEAR(rms_error_mm(mean, b.exact), expected, 0.05 * expected);
    EXPECT_NEAR(rms_error_mm(b.noisy[0], b.exact), kBurstSigma_mm, 0.05 * kBurstSigma_mm) << "control: one burst";
    const std::size_t i = mean.depth_mm.index(40, 30);
    EXPECT_NEAR(static_cast<double>(mean.points[i].z()), static_cast<double>(mean.depth_mm[i]), 1e-6);
    EXPECT_LT(mean.normals[i].z(), 0.0F) << "towards the camera";
  }
}

TEST(MeanPatch, surer_bursts_count_more) {
  Bursts b(2, 3);
  for (float& sigma : b.noisy[0].sigma_mm.pixels()) sigma *= 3;
  const SurfacePatch mean = b.mean();
  const std::size_t i = mean.depth_mm.index(40, 30);
  const double expected =
      (static_cast<double>(b.noisy[0].depth_mm[i]) + 9 * static_cast<double>(b.noisy[1].depth_mm[i])) / 10;
  EXPECT_NEAR(static_cast<double>(mean.depth_mm[i]), expected, 1e-5);
  EXPECT_NEAR(static_cast<double>(mean.sigma_mm[i]), kBurstSigma_mm * std::sqrt(0.9), 1e-5);
}

TEST(MeanPatch, a_burst_that_lies_elsewhere_is_left_out) {
  Bursts b(4, 5);
  const double clean = rms_error_mm(b.mean(), b.exact);
  for (float& z : b.noisy[2].depth_mm.pixels()) z += 0.5F;
  EXPECT_LT(rms_error_mm(b.mean(), b.exact), 1.3 * clean) << "three are left of four";
  EXPECT_GT(rms_error_mm(b.mean({.gate_sigmas = 1e6}), b.exact), 10 * clean) << "control: without the gate";
  Bursts two(2, 6);
  for (float& z : two.noisy[1].depth_mm.pixels()) z += 0.5F;
  EXPECT_EQ(two.mean().valid_px, 0U) << "two that differ: neither is believed";
}

TEST(MeanPatch, what_one_burst_alone_saw_is_asked_for_twice) {
  Bursts b(3, 7);
  const std::size_t i = b.exact.depth_mm.index(40, 30);
  b.noisy[0].depth_mm[i] = b.noisy[1].depth_mm[i] = kNothing;
  const SurfacePatch mean = b.mean();
  EXPECT_TRUE(std::isnan(mean.depth_mm[i]) && std::isnan(mean.sigma_mm[i]) && std::isnan(mean.points[i].x()));
  EXPECT_TRUE(std::isnan(mean.normals[i].x()));
  EXPECT_FALSE(std::isnan(b.mean({.min_agreeing = 1}).depth_mm[i]));
  b.noisy.resize(1);
  EXPECT_EQ(b.mean().valid_px, b.noisy[0].valid_px) << "two were not given";
}

TEST(MeanPatch, nothing_and_patches_of_another_size_are_passed_over) {
  Bursts b(2, 8);
  EXPECT_TRUE(mean_patch({}, b.rays, {}, {}).depth_mm.empty());
  b.noisy.emplace_back();
  b.noisy.push_back(ts::make_patch(ts::SyntheticSurface(1), ts::test_rig(4).camera, ts::looking_down(0, 0), {}));
  const SurfacePatch mean = b.mean();
  EXPECT_NEAR(static_cast<double>(mean.sigma_mm[mean.sigma_mm.index(40, 30)]), kBurstSigma_mm / std::sqrt(2.0), 1e-4);
}

TEST(MeanPatch, texture_is_of_the_first_burst_that_has_one) {
  Bursts b(3, 9);
  b.noisy[0].texture_dn = {};
  const SurfacePatch mean = b.mean();
  ASSERT_FALSE(mean.texture_dn.empty());
  EXPECT_EQ(mean.texture_dn[500], b.noisy[1].texture_dn[500]);
}

TEST(LiveImage, is_cut_to_bytes_and_black_where_nothing_is) {
  Map<float> dn(64, 3, 0.0F);
  for (std::size_t i = 0; i < dn.size(); ++i) dn[i] = static_cast<float>(400 * ts::uniform(i) - 50);
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<std::pair<float, int>> edges{{kNothing, 0}, {-1.0F, 0},    {-0.0F, 0},    {0.99F, 0},
                                                 {1.0F, 1},     {254.9F, 254}, {255.0F, 255}, {255.1F, 255},
                                                 {1e30F, 255},  {inf, 255},    {-inf, 0}};
  for (std::size_t k = 0; k < edges.size(); ++k) dn[k] = edges[k].first;
  const Map<std::uint8_t> grey = stage::live_image(dn);
  ASSERT_EQ(grey.width(), 64);
  for (std::size_t k = 0; k < edges.size(); ++k) EXPECT_EQ(int{grey[k]}, edges[k].second) << edges[k].first;
  for (std::size_t i = edges.size(); i < dn.size(); ++i)
    EXPECT_EQ(int{grey[i]}, static_cast<int>(std::floor(std::clamp(dn[i], 0.0F, 255.0F)))) << dn[i];
  EXPECT_TRUE(stage::live_image({}).empty());
}

}  // namespace
}  // namespace enamel::pipeline
