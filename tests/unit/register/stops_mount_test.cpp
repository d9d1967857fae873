// The mount's lines from a scan's own poses, and the circle that they have to close.
#include <gtest/gtest.h>

#include "pipeline/register/stops/closing.hpp"
#include "pipeline/register/stops/mount_refit.hpp"
#include "tests/unit/register/stops_scene.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr double kReach_mm = 9;  // half a field
constexpr std::uint64_t kMountSeeds = 8;
constexpr double kPlantedDeg = 0.01, kPlanted_mm = 0.02;

/// Two rounds and a half at five swings, what a stop adds of its own drawn at `scale` of its sigma.
std::vector<StopPose> drawn_stops(const calib::Mount& truth, std::uint64_t seed, double scale) {
  const StopSigma sigma;
  std::vector<StopPose> out;
  std::uint64_t key = ts::mix(seed + 4000);
  for (const double swing : {-30.0, -15.0, 0.0, 15.0, 30.0}) {
    for (int k = 0; k < 24; ++k, key += 16) {
      const auto at = ts::angles_deg(15.0 * k, swing);
      AxesOffset by{scale * sigma.angle_rad * ts::normal(key), scale * sigma.angle_rad * ts::normal(key + 1)};
      by.before_camera.translation() =
          scale * sigma.shift_mm * Vec3d(ts::normal(key + 2), ts::normal(key + 3), ts::normal(key + 4));
      const Pose T = pose_by_axes(truth, at, by);
      out.push_back({at, T, T * Vec3d(0, 0, 48)});
    }
  }
  return out;
}

/// Both lines tilted and shifted, square to themselves.
calib::Mount planted(const calib::Mount& start, std::uint64_t seed) {
  calib::Mount out = start;
  std::uint64_t key = ts::mix(seed + 9000);
  for (calib::AxisLine* line : {&out.rotation, &out.swing}) {
    const Vec3d d = ts::vec(line->direction);
    const Vec3d shift = kPlanted_mm * d.cross(ts::drawn_direction(++key)).normalized();
    const Vec3d seen = Vec3d(0, 0, 48), foot = ts::vec(line->point_mm) + d * d.dot(seen - ts::vec(line->point_mm));
    line->direction = ts::triple(ts::tilted(d, ts::rad(kPlantedDeg), ++key));
    line->point_mm = ts::triple(foot + shift);
  }
  return out;
}

calib::LineDifference off(const calib::AxisLine& a, const calib::AxisLine& b) {
  return calib::compare_lines(a, b, {0, 0, 48}, kReach_mm);
}

/// derived: 120 stops of 3 um run-out leave the rotation 3 um sqrt(2/120) = 0.4 um, and the swing, whose arcs are half
/// a radian, some 2 um; the prior of 3 um then keeps up to (1/3)^2 of 20 um.
constexpr double kRotationPlace_mm = 0.003, kSwingPlace_mm = 0.006;
/// derived: turns that an angle of the other axis makes as well are known to 0.03 deg / sqrt(120) = 4.8e-5 rad: about
/// as the prior, which keeps up to half of what was planted; and 2.5 sigma of 3.5e-5. So are all of the swing, which
/// turns by half a radian only …
constexpr double kLoose_rad = 0.5 * kPlantedDeg * calib::kRadPerDegree + 9e-5;
/// … and those of the rotation that none makes are known to 3 um / 27 mm sqrt(2/120) = 1.4e-5 rad, at 2 sigma.
constexpr double kTight_rad = 3e-5;

TEST(MountRefit, a_mount_that_is_off_is_found) {
  for (std::uint64_t seed = 0; seed < kMountSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const calib::Mount start = ts::drawn_mount(seed), truth = planted(start, seed);
    const calib::Mount found = refit_mount(start, drawn_stops(truth, seed, 1), {}, {}, ts::kRho_mm);
    EXPECT_GT(off(start.rotation, truth.rotation).distance_mm, 0.9 * kPlanted_mm) << "control: the start is off";
    EXPECT_GT(off(start.swing, truth.swing).distance_mm, 0.9 * kPlanted_mm);
    EXPECT_LT(off(found.rotation, truth.rotation).distance_mm, kRotationPlace_mm);
    EXPECT_LT(off(found.swing, truth.swing).distance_mm, kSwingPlace_mm);
    EXPECT_LT(off(found.rotation, truth.rotation).angle_rad, kLoose_rad);
    EXPECT_LT(off(found.swing, truth.swing).angle_rad, kLoose_rad);
    const Vec3d turn = ts::vec(found.rotation.direction).cross(ts::vec(truth.rotation.direction));
    const Vec3d by_swing = ts::vec(truth.swing.direction);
    EXPECT_LT((turn - by_swing * by_swing.dot(turn)).norm(), kTight_rad);
  }
}

TEST(MountRefit, a_mount_that_is_right_stays) {
  for (std::uint64_t seed = 0; seed < kMountSeeds; ++seed) {
    const calib::Mount start = ts::drawn_mount(seed);
    const calib::Mount exact = refit_mount(start, drawn_stops(start, seed, 0), {}, {}, ts::kRho_mm);
    EXPECT_LT(off(exact.rotation, start.rotation).distance_mm, 1e-6) << seed;
    EXPECT_LT(off(exact.swing, start.swing).distance_mm, 1e-6) << seed;
    const calib::Mount noisy = refit_mount(start, drawn_stops(start, seed, 1), {}, {}, ts::kRho_mm);
    EXPECT_LT(off(noisy.rotation, start.rotation).distance_mm, MountSigma().place_mm) << seed;
    EXPECT_LT(off(noisy.swing, start.swing).distance_mm, 2 * MountSigma().place_mm) << seed;
    EXPECT_EQ(noisy.serial, start.serial);
  }
}

TEST(MountRefit, what_no_stop_tells_stays_as_calibrated) {
  const calib::Mount start = ts::drawn_mount(1), truth = planted(start, 1);
  std::vector<StopPose> few = drawn_stops(truth, 1, 1);
  few.resize(2);
  const calib::Mount kept = refit_mount(start, few, {}, {}, ts::kRho_mm);
  EXPECT_EQ(kept.rotation.direction, start.rotation.direction) << "too few";
  EXPECT_EQ(kept.rotation.point_mm, start.rotation.point_mm);
  // All at one swing: the swing axis never moved.
  std::vector<StopPose> one = drawn_stops(truth, 1, 0);
  one.resize(24);
  for (StopPose& stop : one) {
    stop.angles.swing_command = 0;
    stop.T_model_cam = pose_by_axes(truth, stop.angles);
    stop.centre = stop.T_model_cam * Vec3d(0, 0, 48);
  }
  const calib::Mount found = refit_mount(start, one, {}, {}, ts::kRho_mm);
  EXPECT_LT(off(found.swing, start.swing).distance_mm, 1e-4);
  EXPECT_LT(off(found.rotation, truth.rotation).distance_mm, kRotationPlace_mm);
}

TEST(MountRefit, one_wrong_stop_has_no_say_and_many_have) {
  for (std::uint64_t seed = 0; seed < kMountSeeds; ++seed) {
    const calib::Mount start = ts::drawn_mount(seed);
    const auto with_wrong = [&](std::size_t every) {
      std::vector<StopPose> stops = drawn_stops(start, seed, 1);
      for (std::size_t k = 7; k < stops.size(); k += every)
        stops[k].T_model_cam = Pose(Eigen::Translation3d(0.3 * ts::drawn_direction(seed + k))) * stops[k].T_model_cam;
      return refit_mount(start, stops, {}, {}, ts::kRho_mm);
    };
    const calib::Mount clean = refit_mount(start, drawn_stops(start, seed, 1), {}, {}, ts::kRho_mm);
    // derived: trusted, a stop of 120 that is 0.3 mm off moves a place by 2 * 300 / 120 = 5 um
    EXPECT_LT(off(with_wrong(1000).rotation, clean.rotation).distance_mm, 2e-4) << seed;
    EXPECT_LT(off(with_wrong(1000).swing, clean.swing).distance_mm, 5e-4) << seed;
  }
}

/// A ring of stops `step_deg` apart with exact edges between neighbours, both ways.
struct Ring {
  std::vector<Stop> stops;
  std::vector<Pose> T;
  std::vector<MapEdge> edges;
};

void join(Ring& of, std::size_t i, std::size_t j, const Pose& wrong_by = Pose::Identity()) {
  const Vec3d centre(0, 0, 48);
  MapEdge one, other;
  one.i = other.j = i, one.j = other.i = j;
  one.centre = other.centre = centre;
  one.T_j_i = of.T[j].inverse() * of.T[i] * wrong_by;
  other.T_j_i = one.T_j_i.inverse();
  of.edges.push_back(one);
  of.edges.push_back(other);
}

Ring ring(std::uint64_t seed, int stops, double step_deg) {
  Ring out;
  const calib::Mount m = ts::drawn_mount(seed);
  for (int k = 0; k < stops; ++k) {
    Stop stop;
    stop.angles = ts::angles_deg(step_deg * k, 10);
    stop.centre = {0, 0, 48};
    out.T.push_back(pose_by_axes(m, stop.angles));
    out.stops.push_back(std::move(stop));
  }
  return out;
}
void join_neighbours(Ring& of, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) join(of, (k + 1) % of.stops.size(), k);
}

TEST(Circles, exact_edges_close_and_a_planted_error_shows) {
  for (std::uint64_t seed = 0; seed < kMountSeeds; ++seed) {
    Ring whole = ring(seed, 24, 15);
    join_neighbours(whole, 24);
    const auto closed = find_circles(whole.stops, whole.edges, whole.T, whole.T);
    ASSERT_EQ(closed.size(), 1U);
    EXPECT_EQ(closed[0].stops, 24U);
    EXPECT_NEAR(closed[0].swing_deg, 10, 1e-9);
    EXPECT_LT(closed[0].chain_mm, 1e-9);
    EXPECT_LT(closed[0].after_mm, 1e-9);
    const auto k = static_cast<std::size_t>(ts::drawn_in(seed + 3, 0, 22));
    Ring open = ring(seed, 24, 15);
    join_neighbours(open, 24);
    const double error_mm = ts::drawn_in(seed + 5, 0.01, 0.05);
    const Pose wrong(Eigen::Translation3d(error_mm * ts::drawn_direction(seed)));
    std::erase_if(open.edges, [&](const MapEdge& e) { return std::min(e.i, e.j) == k && std::max(e.i, e.j) == k + 1; });
    join(open, k + 1, k, wrong);
    const auto found = find_circles(open.stops, open.edges, open.T, open.T);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_NEAR(found[0].chain_mm, error_mm, 1e-9) << seed;
    EXPECT_LT(found[0].after_mm, 1e-9) << "not at the seam";
  }
}

TEST(Circles, what_does_not_go_all_round_is_none) {
  Ring gap = ring(1, 24, 15);
  join_neighbours(gap, 23);
  EXPECT_TRUE(find_circles(gap.stops, gap.edges, gap.T, gap.T).empty()) << "a neighbour is missing";
  // Half an arc whose ends see each other, as neighbours in the list of its angles.
  Ring arc = ring(1, 5, 10);
  join_neighbours(arc, 5);
  EXPECT_TRUE(find_circles(arc.stops, arc.edges, arc.T, arc.T).empty()) << "320 degrees are missing";
  Ring few = ring(1, 3, 120);
  join_neighbours(few, 3);
  EXPECT_TRUE(find_circles(few.stops, few.edges, few.T, few.T).empty());
  EXPECT_TRUE(find_circles({}, {}, {}, {}).empty());
}

TEST(Circles, a_stop_taken_twice_counts_once_and_full_turns_do_not_matter) {
  Ring twice = ring(2, 25, 15);  // the last one stands where the first did
  for (std::size_t k = 0; k < 24; ++k) twice.stops[k].angles.rotation_command -= ts::rad(k % 2 == 0 ? 360 : 0);
  join_neighbours(twice, 24);
  join(twice, 0, 23);
  const auto found = find_circles(twice.stops, twice.edges, twice.T, twice.T);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].stops, 24U);
  EXPECT_LT(found[0].chain_mm, 1e-9);
}

}  // namespace
}  // namespace enamel::pipeline
