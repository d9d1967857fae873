// A plane slides on itself: texture tells where it is, noise and another surface's texture do not, and what nothing
// tells is said to be undetermined.
#include "pipeline/register/icp/texture_term.hpp"

#include <gtest/gtest.h>

#include <algorithm>

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

class TextureTerm : public ::testing::Test {
 protected:
  /// Both patches aligned by shape from `start`, in the frame of the first, then held by texture.
  std::optional<TextureHold> hold(const SurfacePatch& first, const SurfacePatch& second, const Pose& start) {
    const Reference reference(view_from_patch(first, Pose::Identity(), rig_.camera), icp_.reference);
    const PatchPyramid pyramid = make_pyramid(second, icp_);
    by_shape_ = align(pyramid, reference, ViewCamera(rig_.camera), start, start, icp_);
    EXPECT_TRUE(by_shape_.converged);
    EXPECT_EQ(by_shape_.weak_directions, 3) << "a plane: two shifts and a turn";
    BurstTexture of_first(first, config_), of_second(second, config_);
    const TextureReference texture = texture_reference(*of_first.picture(), Pose::Identity());
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
