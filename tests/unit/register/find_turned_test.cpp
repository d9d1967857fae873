// Finding a patch again from another side, and the evidence for a place.
#include "pipeline/register/track/find_turned.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <vector>

#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/track/tracker.hpp"
#include "tests/unit/register/turned_patches.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

/// A surface seen from above along x, and patches asked for among these keyframes.
class Scene {
 public:
  explicit Scene(std::uint64_t seed, std::int64_t repeat = 0)
      : rig_(ts::test_rig(2)), surface_(seed, 1, repeat), store_(rig_.camera, without_pictures()) {}

  void show(double x) {
    const Pose T_model_cam = ts::looking_down(x, 0);
    const SurfacePatch patch = patch_from(surface_, T_model_cam);
    store_.add(patch, T_model_cam, view_from_patch(patch, T_model_cam, rig_.camera, store_.config().view_stride));
  }
  [[nodiscard]] SurfacePatch patch_from(const ts::SyntheticSurface& surface, const Pose& T) const {
    return ts::make_patch(surface, rig_.camera, T, {0.01, 0.03, 77});
  }
  [[nodiscard]] SurfacePatch patch_from(const Pose& T) const { return patch_from(surface_, T); }
  [[nodiscard]] std::optional<Relocalised> ask(const SurfacePatch& patch) {
    const TrackerConfig config;
    const PatchPyramid pyramid = make_pyramid(patch, config.icp);
    const LostPatch lost{patch, pyramid, 7};
    const Pose last = Pose::Identity();
    return relocalise(lost, {store_, last, 0}, rig_.camera, config.icp, config.relocalise);
  }
  [[nodiscard]] PlaceEvidence evidence(const SurfacePatch& patch, const Pose& T) const {
    const ModelView own = view_from_patch(patch, Pose::Identity(), rig_.camera, 4);
    const auto near = keyframes_near(store_.all(), T * Vec3d(0, 0, 48), 48, 8);
    return weigh_place(own, T, store_.all(), near, ViewCamera(rig_.camera), {});
  }

 private:
  /// Votes alone: the pictures' features cannot help out.
  static KeyframeConfig without_pictures() {
    KeyframeConfig config;
    config.max_described = 0;
    return config;
  }

  calib::Rig rig_;
  ts::SyntheticSurface surface_;
  KeyframeStore store_;
};

TEST(FindTurned, finds_single_patches_from_other_sides_and_rolls) {
  int found = 0;
  int wrong = 0;
  int asked = 0;
  for (std::uint64_t seed = 60; seed < 64; ++seed) {
    Scene scene(seed);
    for (const double x : {-2.0, 0.0, 2.0}) scene.show(x);
    for (const double turn : {20.0, 140.0, 260.0}) {
      const Pose truth = ts::looking_from(0.7, -0.4, 40, turn + static_cast<double>(seed), 2 * turn);
      const auto place = scene.ask(scene.patch_from(truth));
      ++asked;
      if (place) ++(ts::point_error_mm(place->icp.T_model_cam, truth) < 0.03 ? found : wrong);
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(found, asked - 2);
}

TEST(FindTurned, refuses_mirror_images_and_other_surfaces) {
  Scene scene(70);
  for (const double x : {-2.0, 0.0, 2.0}) scene.show(x);
  for (const double tilt : {0.0, 30.0}) {
    const Pose T = ts::looking_from(0.5, 0.3, tilt, 45, 20);
    EXPECT_TRUE(scene.ask(scene.patch_from(T))) << "positive control " << tilt;
    EXPECT_FALSE(scene.ask(ts::mirrored(scene.patch_from(T)))) << tilt;
    for (std::uint64_t other = 700; other < 704; ++other) {
      EXPECT_FALSE(scene.ask(scene.patch_from(ts::SyntheticSurface(other), T))) << other;
    }
  }
}

TEST(FindTurned, refuses_to_choose_between_places_that_look_alike_from_the_side) {
  const Pose truth = ts::looking_from(24.5, 0.3, 25, 80, 0);
  for (const std::int64_t repeat : {3, 0}) {
    Scene scene(80, repeat);
    for (const double x : {0.0, 24.0}) scene.show(x);
    EXPECT_EQ(scene.ask(scene.patch_from(truth)).has_value(), repeat == 0) << repeat;
  }
}

TEST(PlaceEvidence, knows_the_true_place_from_one_beside_it) {
  Scene scene(90);
  for (const double x : {-2.0, 0.0, 2.0}) scene.show(x);
  const Pose truth = ts::looking_from(0.5, 0.2, 30, 10, 0);
  const SurfacePatch patch = scene.patch_from(truth);
  const PlaceEvidence right = scene.evidence(patch, truth);
  EXPECT_GT(right.overlap, 0.5);
  EXPECT_GT(right.consistency, 0.98);
  for (const Vec3d& shift : {Vec3d(1, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0, 0.8), Vec3d(0, 0, -0.8)}) {
    const PlaceEvidence beside = scene.evidence(patch, Eigen::Translation3d(shift) * truth);
    EXPECT_LT(beside.consistency, 0.8) << shift.transpose();
    EXPECT_LT(beside.overlap, 0.7 * right.overlap) << shift.transpose();
  }
}

/// Moves each point along its ray.
template <class F>
SurfacePatch reshaped(SurfacePatch patch, const F& shift_mm) {
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    Vec3f& p = patch.points[i];
    if (p.x() == p.x()) p *= 1 + static_cast<float>(shift_mm(p, i)) / p.z();
  }
  return patch;
}

TEST(PlaceEvidence, another_form_speaks_against_a_place_and_noise_does_not) {
  Scene scene(92);
  for (const double x : {-2.0, 0.0, 2.0}) scene.show(x);
  const Pose truth = ts::looking_from(0.5, 0.2, 20, 10, 0);
  const SurfacePatch patch = scene.patch_from(truth);
  // A wave of 0.06 mm, 4 mm long, as one incisor differs from the next; and as much of noise.
  const SurfacePatch waved =
      reshaped(patch, [](const Vec3f& p, std::size_t) { return 0.06F * std::sin(1.6F * p.x()); });
  const SurfacePatch noisy = reshaped(patch, [](const Vec3f&, std::size_t i) { return 0.03 * ts::normal(i); });
  const EvidenceConfig config;
  EXPECT_TRUE(convincing(scene.evidence(patch, truth), 0.01, config));
  EXPECT_TRUE(convincing(scene.evidence(noisy, truth), 0.03, config));
  EXPECT_FALSE(convincing(scene.evidence(waved, truth), 0.01, config));
  EXPECT_GT(scene.evidence(waved, truth).form_rms_mm, 2 * scene.evidence(noisy, truth).form_rms_mm);
}

TEST(PlaceEvidence, a_scrap_of_surface_convinces_nobody) {
  Scene scene(93);
  for (const double x : {-2.0, 0.0, 2.0}) scene.show(x);
  const Pose truth = ts::looking_from(0.5, 0.2, 20, 10, 0);
  SurfacePatch scrap = scene.patch_from(truth);
  EXPECT_TRUE(scene.ask(scrap)) << "positive control";
  for (Vec3f& p : scrap.points.pixels()) {
    if (p.head<2>().norm() > 3.5F) p.setConstant(std::numeric_limits<float>::quiet_NaN());
  }
  for (std::size_t i = 0; i < scrap.points.size(); ++i) scrap.depth_mm[i] = scrap.points[i].z();
  EXPECT_FALSE(convincing(scene.evidence(scrap, truth), 0.01, {}));
  EXPECT_FALSE(scene.ask(scrap));
}

TEST(PlaceEvidence, what_was_hidden_does_not_speak_against_a_place) {
  // From the side the patch shows walls that no keyframe saw: less overlap, no less consistency.
  Scene scene(91);
  scene.show(0);
  const Pose above = ts::looking_from(0, 0, 5, 0, 0);
  const Pose aside = ts::looking_from(0, 0, 45, 0, 0);
  EXPECT_LT(scene.evidence(scene.patch_from(aside), aside).overlap,
            scene.evidence(scene.patch_from(above), above).overlap);
  EXPECT_GT(scene.evidence(scene.patch_from(aside), aside).consistency, 0.97);
}

}  // namespace
}  // namespace enamel::pipeline
