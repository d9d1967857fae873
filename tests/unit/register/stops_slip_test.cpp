// Tables and models that move by themselves: found at the stop that shows it, named, measured; nothing found where
// nothing happened.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pipeline/register/stops/slip.hpp"
#include "tests/unit/register/stops_scene.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;
using ts::Mishap;
using Kind = Slip::Kind;

constexpr std::size_t kStops = 9;
constexpr std::uint64_t kSlipSeeds = 3;
constexpr double kLeast_deg = 0.5;

struct Followed {
  FollowedStops out;
  std::vector<Pose> truth;
};

/// To and fro over two swings, 15 degrees apart. `believed`: the mount that the follower is given.
Followed follow(const ts::TableScene& scene, const Mishap& mishap, const calib::Mount& believed) {
  StopFollower follower(believed, scene.rules(), {});
  Followed out;
  for (std::size_t k = 0; k < kStops; ++k) {
    const auto told = ts::angles_deg(15.0 * static_cast<double>(k / 2), k % 4 == 1 || k % 4 == 2 ? 12 : -3);
    out.truth.push_back(scene.truth(k, told, mishap));
    follower.follow(scene.stop(k, told, out.truth.back()));
  }
  out.out = follower.followed();
  return out;
}
Followed follow(const ts::TableScene& scene, const Mishap& mishap) { return follow(scene, mishap, scene.mount); }

/// Farthest that a stop's surface was put from where it is, the mishap allowed for: first stop's error aside, which all
/// share.
double worst_mm(const Followed& f) {
  double worst = 0;
  for (std::size_t k = 0; k < kStops; ++k)
    worst = std::max(worst, ts::point_error_mm(f.out.T_model_cam[k], f.truth[k]));
  return worst;
}
/// derived: angles of 0.01 degrees at 30 mm are 5 um, three of them at 3 sigma and edges of some microns.
constexpr double kPlaced_mm = 0.04;

std::size_t drawn_stop(std::uint64_t seed) { return 2 + static_cast<std::size_t>(ts::drawn_in(seed + 31, 0, 4.999)); }

/// Exactly one, of that kind at that stop; what followed lies where it is.
Slip only_slip(const Followed& f, const Mishap& mishap, Kind kind) {
  std::string all;
  for (const Slip& slip : f.out.slips) all += slip.text() + "\n";
  EXPECT_EQ(f.out.slips.size(), 1U) << all;
  if (f.out.slips.empty()) return {};
  const Slip& slip = f.out.slips[0];
  EXPECT_EQ(slip.stop, mishap.at) << slip.text();
  EXPECT_EQ(slip.kind, kind) << slip.text();
  EXPECT_LT(worst_mm(f), kPlaced_mm) << slip.text();
  for (const Laid laid : f.out.laid) EXPECT_NE(laid, Laid::kNot);
  return slip;
}

TEST(Slips, none_where_nothing_happened) {
  for (std::uint64_t seed = 0; seed < 2 * kSlipSeeds; ++seed) {
    const ts::TableScene scene(seed + 50);
    const Followed f = follow(scene, {.at = kStops});
    EXPECT_TRUE(f.out.slips.empty()) << seed << ": " << f.out.slips[0].text();
    EXPECT_LT(worst_mm(f), kPlaced_mm);
    EXPECT_EQ(f.out.laid[0], Laid::kAlone);
    for (std::size_t k = 1; k < kStops; ++k) EXPECT_EQ(f.out.laid[k], Laid::kLaid) << seed << ' ' << k;
  }
}

/// derived: read angles of 0.01 degrees at both stops, at 4 sigma.
constexpr double kAngle_deg = 4 * 1.5 * ts::TableScene::kAngle_deg;

TEST(Slips, a_lost_step_of_the_rotation_is_found_and_allowed_for) {
  for (std::uint64_t seed = 0; seed < 2 * kSlipSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const double sign = seed % 2 == 0 ? 1 : -1;
    const Mishap mishap{.at = drawn_stop(seed), .rotation_deg = sign * ts::drawn_in(seed + 11, kLeast_deg, 3.5)};
    const Slip slip = only_slip(follow(ts::TableScene(seed), mishap), mishap, Kind::kRotation);
    EXPECT_NEAR(slip.rotation_deg, mishap.rotation_deg, kAngle_deg) << slip.text();
    EXPECT_NEAR(slip.swing_deg, 0, 4 * kAngle_deg) << slip.text();
  }
}

TEST(Slips, a_lost_step_of_the_swing_is_found_and_allowed_for) {
  for (std::uint64_t seed = 0; seed < kSlipSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const double sign = seed % 2 == 0 ? 1 : -1;
    const Mishap mishap{.at = drawn_stop(seed + 7), .swing_deg = sign * ts::drawn_in(seed + 12, kLeast_deg, 3.5)};
    const Slip slip = only_slip(follow(ts::TableScene(seed + 10), mishap), mishap, Kind::kSwing);
    EXPECT_NEAR(slip.swing_deg, mishap.swing_deg, kAngle_deg) << slip.text();
  }
}

/// Along the table's plane, square to the rotation axis.
Pose slide(const ts::TableScene& scene, double mm, std::uint64_t key) {
  const Vec3d axis = ts::vec(scene.mount.rotation.direction);
  return Pose(Eigen::Translation3d(mm * axis.cross(ts::drawn_direction(key)).normalized()));
}

TEST(Slips, a_model_that_slid_on_the_table_is_found_and_allowed_for) {
  for (std::uint64_t seed = 0; seed < 2 * kSlipSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const ts::TableScene scene(seed + 20);
    const double mm = ts::drawn_in(seed + 13, 0.3, 1);
    const Mishap mishap{.at = drawn_stop(seed + 8), .on_table = slide(scene, mm, seed + 14)};
    static_cast<void>(only_slip(follow(scene, mishap), mishap, Kind::kModel));
  }
}

/// A knock on the head: a shift and a turn about where it looks.
Pose knock(std::uint64_t seed) {
  const Vec3d at(0, 0, 48);
  const Pose turn = Eigen::Translation3d(at) * Eigen::AngleAxisd(ts::rad(0.5), ts::drawn_direction(seed + 1)) *
                    Eigen::Translation3d(-at);
  return Eigen::Translation3d(ts::drawn_in(seed + 2, 0.3, 0.6) * ts::drawn_direction(seed)) * turn;
}

TEST(Slips, a_bumped_table_is_found_and_allowed_for) {
  for (std::uint64_t seed = 0; seed < kSlipSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Mishap mishap{.at = drawn_stop(seed + 9), .before_camera = knock(seed)};
    static_cast<void>(only_slip(follow(ts::TableScene(seed + 30), mishap), mishap, Kind::kTable));
  }
}

TEST(Slips, a_stop_bumped_once_is_told_from_what_stays) {
  for (std::uint64_t seed = 0; seed < kSlipSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Mishap mishap{.at = drawn_stop(seed + 5), .before_camera = knock(seed + 70), .once = true};
    static_cast<void>(only_slip(follow(ts::TableScene(seed + 40), mishap), mishap, Kind::kOnce));
  }
}

TEST(Slips, the_mount_of_another_scanner_does_not_pass) {
  for (std::uint64_t seed = 0; seed < kSlipSeeds; ++seed) {
    const ts::TableScene scene(seed + 60);
    const Followed f = follow(scene, {.at = kStops}, ts::drawn_mount(seed + 1000));
    EXPECT_TRUE(!f.out.slips.empty() || std::ranges::count(f.out.laid, Laid::kNot) > 0) << seed;
  }
}

TEST(Slips, are_told_in_words) {
  Slip slip{3, Kind::kRotation, 1.8, 0.01, 0.002};
  EXPECT_NE(slip.text().find("from stop 3 on the rotation is off"), std::string::npos);
  EXPECT_NE(slip.text().find("+1.800 deg of rotation"), std::string::npos);
  slip.kind = Kind::kOnce;
  EXPECT_NE(slip.text().find("stop 3 alone"), std::string::npos);
}

}  // namespace
}  // namespace enamel::pipeline
