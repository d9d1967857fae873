// A plane slides on itself: texture tells where it is, noise and another surface's texture do not, and what nothing
// tells is said to be undetermined.
#include "pipeline/register/icp/texture_term.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/register/icp/patch_view.hpp"
#include "pipeline/register/track/burst_texture.hpp"
#include "tests/unit/register/track_session.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

const ts::SyntheticSurface kPlane(31, 0);

SurfacePatch seen(const ts::SyntheticSurface& surface, const Pose& from, std::uint64_t seed) {
  const calib::Rig rig = ts::test_rig(2);
  return ts::make_patch(surface, rig.camera, from, {0.005, 0.03, seed});
}

/// Grey without a texture but with the noise of a camera.
void paint_plain(SurfacePatch& patch, std::uint64_t seed) {
  for (std::size_t i = 0; i < patch.texture_dn.size(); ++i)
    patch.texture_dn[i] = static_cast<float>(120 + 1.2 * ts::normal(ts::mix(seed) + i));
}

/// Waves of two lengths across x, in the frame that T takes camera points to, with the noise of a camera.
void paint_waves(SurfacePatch& patch, const Pose& T, std::uint64_t seed) {
  for (std::size_t i = 0; i < patch.texture_dn.size(); ++i) {
    const double x = (T * patch.points[i].cast<double>()).x();
    const double wave =
        0.08 * std::sin(2 * std::numbers::pi * x / 0.9) + 0.08 * std::sin(2 * std::numbers::pi * x / 1.25);
    patch.texture_dn[i] = static_cast<float>(120 * (1 + wave) + 1.2 * ts::normal(ts::mix(seed) + i));
  }
}

class TextureTerm : public ::testing::Test {
 protected:
  /// Both patches aligned by shape from `start`, in the frame of the first, then held by texture. of_surface: the first
  /// one's texture is known to be the surface's.
  std::optional<TextureHold> hold(const SurfacePatch& first, const SurfacePatch& second, const Pose& start,
                                  bool of_surface = false) {
    const Reference reference(view_from_patch(first, Pose::Identity(), rig_.camera), icp_.reference);
    const PatchPyramid pyramid = make_pyramid(second, icp_);
    by_shape_ = align(pyramid, reference, ViewCamera(rig_.camera), start, start, icp_);
    EXPECT_TRUE(by_shape_.converged);
    EXPECT_EQ(by_shape_.weak_directions, 3) << "a plane: two shifts and a turn";
    BurstTexture of_first(first, config_), of_second(second, config_);
    TextureReference texture = texture_reference(*of_first.picture(), Pose::Identity());
    texture.of_surface = of_surface;
    centre_ = by_shape_.T_model_cam * pyramid.levels.back().centroid;
    const WeakDirections weak = weak_directions(by_shape_.system, icp_.prior.weak_eigenvalue);
    return hold_by_texture({of_second.points(), texture, rig_.camera, centre_, icp_.rho_mm}, by_shape_.T_model_cam,
                           weak, config_.term);
  }
  [[nodiscard]] Pose held(const TextureHold& hold) const {
    return apply_motion(hold.x, centre_, icp_.rho_mm, by_shape_.T_model_cam);
  }

  calib::Rig rig_ = ts::test_rig(2);
  IcpConfig icp_;
  BurstTexture::Config config_{{}, {}, ts::test_rig(2).camera.fx / 48, FringePhase(ts::test_rig(2))};
  IcpResult by_shape_;
  Vec3d centre_ = Vec3d::Zero();
};

TEST_F(TextureTerm, a_plane_is_held_where_its_texture_says) {
  for (std::uint64_t draw = 0; draw < 8; ++draw) {
    const auto spread = [&](std::uint64_t k, double most) { return most * (2 * ts::uniform(10 * draw + k) - 1); };
    const Pose from = ts::looking_down(spread(0, 5), spread(1, 5));
    const Pose to = from * Pose(Eigen::Translation3d(spread(2, 1), spread(3, 1), 0) *
                                Eigen::AngleAxisd(spread(4, 0.02), Vec3d::UnitZ()));
    const Pose truth = from.inverse() * to;
    const Pose start = truth * Pose(Eigen::Translation3d(spread(5, 0.2), spread(6, 0.2), 0) *
                                    Eigen::AngleAxisd(spread(7, 0.01), Vec3d::UnitZ()));
    const auto found = hold(seen(kPlane, from, draw), seen(kPlane, to, 100 + draw), start);
    ASSERT_TRUE(found) << draw;
    EXPECT_EQ(found->held, 3);
    EXPECT_LT(ts::point_error_mm(held(*found), truth), 0.006) << draw;
    EXPECT_LT(ts::angle_error_rad(held(*found), truth), 2e-3) << draw;
  }
}

TEST_F(TextureTerm, noise_and_the_texture_of_another_place_hold_nothing) {
  const Pose at = ts::looking_down(0, 0);
  EXPECT_FALSE(hold(seen(kPlane, at, 1), seen(ts::SyntheticSurface(32, 0), at, 2), Pose::Identity()));
  SurfacePatch first = seen(kPlane, at, 3), second = seen(kPlane, at, 4);
  paint_plain(first, 5);
  paint_plain(second, 6);
  EXPECT_FALSE(hold(first, second, Pose::Identity()));
}

TEST_F(TextureTerm, what_lies_beyond_a_hands_start_is_found) {
  for (const double off : {-1.1, -0.7, 0.7, 1.1}) {
    const Pose from = ts::looking_down(1, 2), truth = Pose(Eigen::Translation3d(0.3, -0.2, 0));
    const Pose start = truth * Pose(Eigen::Translation3d(off, 0.3 * off, 0));
    const auto found = hold(seen(kPlane, from, 11), seen(kPlane, from * truth, 12), start);
    ASSERT_TRUE(found) << off;
    EXPECT_TRUE(found->moved);
    EXPECT_LT(ts::point_error_mm(held(*found), truth), 0.006) << off;
  }
}

/// A plane that slides by 0.4 mm, both times under the same picture: dust, or light that comes with the probe.
TEST_F(TextureTerm, what_stands_still_in_the_picture_is_no_hold) {
  const Pose from = ts::looking_down(0, 0), truth = Pose(Eigen::Translation3d(0.4, 0, 0));
  SurfacePatch first = seen(kPlane, from, 21), second = seen(kPlane, from * truth, 22);
  const SurfacePatch grey = seen(kPlane, from, 23);
  first.texture_dn = second.texture_dn = grey.texture_dn;
  EXPECT_FALSE(hold(first, second, Pose::Identity())) << "it says that nothing moved";
  EXPECT_FALSE(hold(first, second, truth));
  // Control: the surface's own texture does hold.
  const auto own = hold(seen(kPlane, from, 21), seen(kPlane, from * truth, 22), truth);
  ASSERT_TRUE(own);
  EXPECT_TRUE(own->moved);
}

TEST_F(TextureTerm, rest_is_believed_once_the_texture_was_seen_to_move) {
  const SurfacePatch first = seen(kPlane, ts::looking_down(0, 0), 31),
                     second = seen(kPlane, ts::looking_down(0, 0), 32);
  EXPECT_FALSE(hold(first, second, Pose::Identity()));
  const auto found = hold(first, second, Pose::Identity(), true);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->moved);
  EXPECT_LT(ts::point_error_mm(held(*found), Pose::Identity()), 0.006);
}

TEST_F(TextureTerm, what_is_the_same_all_along_a_direction_does_not_hold_it) {
  const Pose from = ts::looking_down(0, 0), truth = Pose(Eigen::Translation3d(0.3, 0.3, 0));
  SurfacePatch first = seen(kPlane, from, 41), second = seen(kPlane, from * truth, 42);
  paint_waves(first, from, 43);
  paint_waves(second, from * truth, 44);
  const auto found = hold(first, second, truth);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->held, 2) << "the shift across the waves and the turn";
}

/// Twenty bursts over a plane; the last.
TrackResult scan_plane(bool with_texture) {
  TrackResult last;
  const calib::Rig rig = ts::test_rig(2);
  Tracker tracker(rig, {});
  for (int n = 0; n < 20; ++n) {
    SurfacePatch patch = seen(kPlane, ts::hand(n / 30.0), static_cast<std::uint64_t>(n));
    if (!with_texture) paint_plain(patch, static_cast<std::uint64_t>(n));
    last = tracker.track(BurstId{static_cast<std::uint64_t>(n)}, time_of(n), patch, {});
  }
  return last;
}

TEST(TrackPlane, texture_determines_the_motion) {
  const TrackResult last = scan_plane(true);
  EXPECT_EQ(last.segment, kModelSegment);
  EXPECT_EQ(last.undetermined, 0);
  EXPECT_TRUE(last.texture) << "kept for the map";
  EXPECT_LT(ts::point_error_mm(ts::hand(0) * last.T_model_cam, ts::hand(19 / 30.0)), 0.03);
}

TEST(TrackPlane, without_texture_it_is_said_to_be_undetermined) {
  const TrackResult last = scan_plane(false);
  EXPECT_EQ(last.segment, kModelSegment) << "nothing is thrown away";
  EXPECT_EQ(last.undetermined, 3);
}

}  // namespace
}  // namespace enamel::pipeline
