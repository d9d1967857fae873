// A burst with teeth and a tongue that has moved on since the model saw it: what it weighs in the pose.
#include <gtest/gtest.h>

#include "pipeline/register/icp/icp.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr std::uint8_t kToothShade = 150, kTongueShade = 120, kSoftBelow = 135;

/// Cusps on the left; on the right a tongue, risen by so much and turned a little.
synthetic::Surface mouth(const std::vector<Vec3d>& cusps, double border_mm, double risen_mm, double turned_rad) {
  synthetic::Surface teeth = synthetic::plane({0, 0, -1}, -0.5);
  for (const Vec3d& c : cusps) teeth = synthetic::nearest(teeth, synthetic::sphere(c, 1.6));
  const auto left = synthetic::clipped(teeth, [border_mm](const Vec3d& p) { return p.x() < border_mm; });
  const Vec3d middle(border_mm + 6, 0.5, 8.0 - risen_mm);
  const auto tongue = synthetic::nearest(synthetic::sphere(middle + Vec3d(0, 4 * turned_rad, 0), 9),
                                         synthetic::sphere(middle + Vec3d(1, -2, 6.5 * turned_rad), 8.9));
  return synthetic::nearest(left,
                            synthetic::clipped(tongue, [border_mm](const Vec3d& p) { return p.x() >= border_mm; }));
}

struct Placed {
  double off_mm = 0;  ///< of the place looked at, rms over its neighbourhood
  bool converged = false;
};

Placed placed(std::uint64_t seed, double risen_mm, double soft_weight, bool shaded = true) {
  synthetic::Random random(seed);
  const calib::Rig rig = synthetic::small_rig();
  std::vector<Vec3d> cusps;
  for (int n = 0; n < 6; ++n)
    cusps.push_back(Vec3d{4 * random.uniform() - 5, 6 * random.uniform() - 3, 0.6 + random.uniform()});
  const double border_mm = 0.8 * random.uniform();
  const double turned = 0.02 * (random.uniform() - 0.5);
  const Pose at = synthetic::looking_at(Vec3d::Zero(), Vec3d(0, 0, 1) + 0.2 * random.vector(), 48);
  const Vec3d target = 0.4 * random.vector();
  const Pose truth = synthetic::looking_at(target, Vec3d(0, 0, 1) + 0.2 * random.vector(), 48);
  const SurfacePatch before = render(rig, mouth(cusps, border_mm, 0, 0), at, {.noisy = true, .seed = seed});
  SurfacePatch now =
      render(rig, mouth(cusps, border_mm, risen_mm, turned), truth, {.noisy = true, .seed = seed + 1000});
  if (shaded) {
    now.shade = ShadeMap(now.points.width() / kShadeCell_px, now.points.height() / kShadeCell_px, kNoShade);
    for (int j = 0; j < now.shade.height(); ++j) {
      for (int i = 0; i < now.shade.width(); ++i) {
        const Vec3f p = now.points(i * kShadeCell_px + 4, j * kShadeCell_px + 4);
        if (std::isfinite(p.x()))
          now.shade(i, j) = (truth * p.cast<double>()).x() < border_mm ? kToothShade : kTongueShade;
      }
    }
  }
  IcpConfig config;
  config.samples.soft_weight = soft_weight;
  config.samples.soft_below = kSoftBelow;
  const Reference reference(view_from_patch(before, at, rig.camera), config.reference);
  const IcpResult found = align(make_pyramid(now, config), reference, ViewCamera(rig.camera), truth, truth, config);
  Placed out{0, found.converged};
  for (const Vec3d& p : {Vec3d(-3, 0, 48), Vec3d(3, 0, 48), Vec3d(0, -3, 48), Vec3d(0, 3, 48)})
    out.off_mm += 0.25 * (found.T_model_cam * p - truth * p).squaredNorm();
  out.off_mm = std::sqrt(out.off_mm);
  return out;
}

struct Mean {
  double light = 0, full = 0, hardly = 0;  ///< mm off: with the default, all, a fiftieth of the weight
};

Mean mean_of(double risen_mm) {
  Mean out;
  constexpr int kDrawn = 3;
  for (std::uint64_t seed = 40; seed < 40 + kDrawn; ++seed) {
    const Placed light = placed(seed, risen_mm, SampleConfig{}.soft_weight), full = placed(seed, risen_mm, 1.0);
    out.hardly += placed(seed, risen_mm, 0.02).off_mm / kDrawn;
    EXPECT_TRUE(light.converged && full.converged) << seed;
    out.light += light.off_mm / kDrawn, out.full += full.off_mm / kDrawn;
  }
  return out;
}

TEST(SoftWeight, a_tongue_that_moves_draws_the_pose_less) {
  const Mean moved = mean_of(0.10);  // within the last gate of 0.15 mm: taken for a match
  EXPECT_GT(moved.full, 0.010) << "control: with its full weight the tongue draws the pose";
  EXPECT_LT(moved.light, 0.85 * moved.full);
  EXPECT_LT(moved.hardly, 0.5 * moved.full) << "the less it weighs, the less it draws";
}

TEST(SoftWeight, a_tongue_at_rest_costs_little) {
  const Mean still = mean_of(0);
  EXPECT_LT(still.light, 1.5 * still.full + 0.0005);  // half of the samples at a fifth: sqrt(2 / 1.2) of the noise
}

TEST(SoftWeight, without_shades_nothing_changes) {
  const Placed a = placed(40, 0.1, 0.2, false), b = placed(40, 0.1, 1.0, false);
  EXPECT_EQ(a.off_mm, b.off_mm);
}

}  // namespace
}  // namespace enamel::pipeline
