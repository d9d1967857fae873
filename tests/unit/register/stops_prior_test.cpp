// What a mount says of a stop's pose: against the axes turned by hand, differences, and a dense solution.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pipeline/register/map/pose_graph.hpp"
#include "pipeline/register/stops/mount_prior.hpp"
#include "tests/unit/register/stops_scene.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr std::uint64_t kPriorSeeds = 12;

calib::AxisAngles drawn_angles(std::uint64_t seed) {
  auto out = ts::angles_deg(ts::drawn_in(9 * seed, -180, 360), ts::drawn_in(9 * seed + 1, -40, 40));
  if (seed % 2 == 0) {  // every other stop has encoders
    out.rotation_read = out.rotation_command + ts::rad(0.3);
    out.swing_read = out.swing_command - ts::rad(0.2);
  }
  return out;
}
Vec3d drawn_centre(std::uint64_t seed) { return Vec3d(0, 0, 48) + 20 * ts::drawn_direction(seed + 77); }

TEST(StopsPrior, pose_by_axes_takes_back_what_the_table_turned) {
  for (std::uint64_t seed = 0; seed < kPriorSeeds; ++seed) {
    const calib::Mount m = ts::drawn_mount(seed);
    const calib::AxisAngles at = drawn_angles(seed);
    const auto turn = [](const calib::AxisLine& line, double read, const calib::Triple& p) {
      const double angle = calib::true_angle(read, 0.0, line.harmonic_rad[0], line.harmonic_rad[1]);
      return calib::turned(line.direction, line.point_mm, angle, p);
    };
    for (std::uint64_t k = 0; k < 4; ++k) {
      const Vec3d model = drawn_centre(10 * seed + k);
      const auto camera = turn(m.swing, at.swing(), turn(m.rotation, at.rotation(), ts::triple(model)));
      EXPECT_LT((pose_by_axes(m, at) * ts::vec(camera) - model).norm(), 1e-9) << seed;
    }
    auto other = at;
    other.rotation_read = other.rotation_command = at.rotation() + ts::rad(0.01);
    EXPECT_GT((pose_by_axes(m, other).matrix() - pose_by_axes(m, at).matrix()).norm(), 1e-4) << "angles count";
  }
}

TEST(StopsPrior, offsets_are_put_where_they_belong) {
  const calib::Mount m = ts::drawn_mount(3);
  const calib::AxisAngles at = drawn_angles(3);
  AxesOffset by{ts::rad(1), ts::rad(-2)};
  EXPECT_TRUE(by.is_of_angles_only());
  EXPECT_TRUE(pose_by_axes(m, at, by).isApprox(pose_by_axes(m, turned_by(at, by)), 1e-12));
  by.on_table.translation().x() = 0.4;
  by.before_camera.translation().z() = 0.1;
  EXPECT_FALSE(by.is_of_angles_only());
  const Pose expected = by.on_table * pose_by_axes(m, turned_by(at, by)) * by.before_camera;
  EXPECT_TRUE(pose_by_axes(m, at, by).isApprox(expected, 1e-12));
}

/// By central differences.
AxisMotions differences(const calib::Mount& m, const calib::AxisAngles& at, const Vec3d& centre) {
  constexpr double h = 1e-6;
  const auto along = [&](double a, double b) {
    const Pose before = pose_by_axes(m, turned_by(at, {-a, -b})), after = pose_by_axes(m, turned_by(at, {a, b}));
    return Vector6(motion_between(before, after, centre, ts::kRho_mm) / (2 * h));
  };
  return {along(h, 0), along(0, h)};
}

TEST(StopsPrior, axis_motions_are_the_derivatives_of_the_pose) {
  for (std::uint64_t seed = 0; seed < kPriorSeeds; ++seed) {
    calib::Mount m = ts::drawn_mount(seed);
    m.rotation.harmonic_rad = m.swing.harmonic_rad = {0, 0};
    const auto at = drawn_angles(seed);
    const Vec3d centre = drawn_centre(seed);
    const AxisMotions found = axis_motions(m, at, centre, ts::kRho_mm), expected = differences(m, at, centre);
    // derived: an arc of 2e-6 rad at a lever below 100 mm differs from its chord by 1e-4 of a mm a radian
    EXPECT_LT((found.rotation - expected.rotation).norm(), 1e-4) << seed;
    EXPECT_LT((found.swing - expected.swing).norm(), 1e-4) << seed;
    auto other = at;
    other.rotation_read = other.rotation_command = at.rotation() + ts::rad(5);
    EXPECT_GT((axis_motions(m, other, centre, ts::kRho_mm).swing - expected.swing).norm(), 0.1) << "of another stop";
  }
}

TEST(StopsPrior, a_planted_deviation_is_taken_apart) {
  for (std::uint64_t seed = 0; seed < kPriorSeeds; ++seed) {
    const calib::Mount m = ts::drawn_mount(seed);
    const auto at = drawn_angles(seed);
    const double a = ts::rad(ts::drawn_in(seed + 500, -0.1, 0.1)), b = ts::rad(ts::drawn_in(seed + 600, -0.1, 0.1));
    const Pose told = pose_by_axes(m, at);
    Pose off = pose_by_axes(m, turned_by(at, {a, b}));
    const Vec3d centre = drawn_centre(seed);
    const AxisMotions motions = axis_motions(m, at, centre, ts::kRho_mm);
    const StopDeviation of_angles = take_apart(motion_between(told, off, centre, ts::kRho_mm), motions);
    // derived: harmonics of 0.02 degrees are 3.5e-4 of an angle of 0.1, and so are chords of arcs of 0.1 degrees
    EXPECT_NEAR(of_angles.rotation_rad, a, ts::rad(2e-4)) << seed;
    EXPECT_NEAR(of_angles.swing_rad, b, ts::rad(2e-4)) << seed;
    EXPECT_LT(of_angles.rest_mm, 5e-4) << seed;
    Vector6 shift = Vector6::Zero();
    shift.tail<3>() = 0.05 * motions.rotation.tail<3>().cross(motions.swing.tail<3>()).normalized();  // by no angle
    off = apply_motion(shift, centre, ts::kRho_mm, off);
    EXPECT_NEAR(take_apart(motion_between(told, off, centre, ts::kRho_mm), motions).rest_mm, 0.05, 1e-3) << seed;
  }
}

TEST(StopsPrior, a_covariance_is_loose_along_the_axes_and_tight_beside_them) {
  const StopSigma sigma;
  const AxisMotions motions = axis_motions(ts::drawn_mount(1), drawn_angles(1), drawn_centre(1), ts::kRho_mm);
  const Matrix6 C = pose_covariance(motions, sigma, ts::kRho_mm);
  const Vector6 along = motions.rotation.normalized();
  EXPECT_GT(std::sqrt(along.dot(C * along)), 0.9 * sigma.angle_rad * motions.rotation.norm());
  Vector6 beside = Vector6::Zero();
  beside.tail<3>() = motions.rotation.tail<3>().cross(motions.swing.tail<3>()).normalized();
  EXPECT_NEAR(std::sqrt(beside.dot(C * beside)), sigma.shift_mm, 1e-9);
}

/// Poses of three nodes, two edges, priors of nodes 1 and 2 about centres of their own: all drawn.
struct SmallGraph {
  std::vector<Pose> poses;
  std::vector<MapEdge> edges;
  std::vector<PosePrior> priors;
  GraphConfig config;
};

Vector6 drawn_motion(std::uint64_t key, double scale) {
  Vector6 x;
  for (int k = 0; k < 6; ++k) x[k] = scale * ts::normal(ts::mix(key) + static_cast<std::uint64_t>(k));
  return x;
}
Matrix6 drawn_information(std::uint64_t key, double scale) {
  Matrix6 A = Matrix6::Identity();
  for (int k = 0; k < 6; ++k) A.col(k) += 0.3 * drawn_motion(key + static_cast<std::uint64_t>(k), 1);
  return scale * A * A.transpose();
}

SmallGraph drawn_graph(std::uint64_t seed) {
  SmallGraph out;
  out.config.bias_mm = out.config.bias_rad = 0;
  const std::uint64_t key = 1000 * seed;
  for (std::uint64_t k = 0; k < 3; ++k) {
    const auto at = ts::angles_deg(15.0 * static_cast<double>(k), 0);
    out.poses.push_back(pose_by_axes(ts::drawn_mount(seed), at));
  }
  for (std::size_t i = 1; i < 3; ++i) {
    MapEdge edge;
    edge.i = i, edge.j = i - 1;
    edge.centre = Vec3d(2, -1, 48);
    edge.T_j_i =
        apply_motion(drawn_motion(key + i, 1e-3), edge.centre, ts::kRho_mm, out.poses[i - 1].inverse() * out.poses[i]);
    edge.H = 1e5 * Matrix6::Identity();
    out.edges.push_back(edge);
    const Vec3d centre = out.poses[i] * Vec3d(-3, 4, 45);
    out.priors.push_back({i, apply_motion(drawn_motion(key + 10 + i, 1e-3), centre, ts::kRho_mm, out.poses[i]), centre,
                          drawn_information(key + 20 + 10 * i, 1e5)});
  }
  return out;
}

/// The step that a dense Gauss-Newton solver with numeric derivatives would still make, edges weighed by `edge_weight`.
double step_left_mm(const SmallGraph& g, const std::vector<Pose>& at, double edge_weight) {
  const auto residuals = [&](const Eigen::VectorXd& x) {
    std::vector<Pose> poses = at;
    for (std::size_t k = 1; k < 3; ++k) {
      const Vector6 by = x.segment<6>(static_cast<Eigen::Index>(6 * (k - 1)));
      poses[k] = apply_motion(by, poses[k] * Vec3d(0, 0, 48), ts::kRho_mm, poses[k]);
    }
    Eigen::VectorXd r(24);
    for (std::size_t n = 0; n < 2; ++n) {
      const MapEdge& e = g.edges[n];
      const Matrix6 edge_root = Matrix6((edge_weight * e.H).llt().matrixU()),
                    prior_root = g.priors[n].information.llt().matrixU();
      r.segment<6>(static_cast<Eigen::Index>(12 * n)) =
          edge_root * motion_between(e.T_j_i, poses[e.j].inverse() * poses[e.i], e.centre, ts::kRho_mm);
      r.segment<6>(static_cast<Eigen::Index>(12 * n + 6)) =
          prior_root * motion_between(g.priors[n].T_model_node, poses[n + 1], g.priors[n].centre, ts::kRho_mm);
    }
    return r;
  };
  constexpr double h = 1e-6;
  Eigen::MatrixXd J(24, 12);
  for (int k = 0; k < 12; ++k) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
    x[k] = h;
    J.col(k) = (residuals(x) - residuals(-x)) / (2 * h);
  }
  const Eigen::VectorXd r = residuals(Eigen::VectorXd::Zero(12));
  return (J.transpose() * J).ldlt().solve(J.transpose() * r).norm();
}

TEST(PosePrior, edges_and_priors_are_weighed_as_their_information_says) {
  for (std::uint64_t seed = 0; seed < kPriorSeeds; ++seed) {
    const SmallGraph g = drawn_graph(seed);
    const SolvedGraph solved = solve_graph(g.poses, g.edges, g.config, {}, g.priors);
    ASSERT_LT(solved.sigma0, 1) << "then edges weigh as they say";
    // derived: its derivatives are those of small motions; residuals of 1e-3 mm turn by 2e-4 rad, of which steps go
    // wrong
    EXPECT_LT(step_left_mm(g, solved.poses, 1), 1e-6) << seed;
    EXPECT_GT(step_left_mm(g, solved.poses, 3), 1e-5) << seed << ": negative control, other weights";
  }
}

TEST(PosePrior, alone_it_is_what_comes_out) {
  for (std::uint64_t seed = 0; seed < kPriorSeeds; ++seed) {
    const SmallGraph g = drawn_graph(seed);
    const SolvedGraph solved = solve_graph(g.poses, {}, g.config, {}, g.priors);
    for (const PosePrior& prior : g.priors) {
      const Vector6 off = motion_between(prior.T_model_node, solved.poses[prior.node], prior.centre, ts::kRho_mm);
      EXPECT_LT(off.norm(), 1e-7) << seed;
    }
    EXPECT_TRUE(solved.poses[0].isApprox(g.poses[0], 0)) << "node 0 is fixed";
    EXPECT_EQ(solve_graph(g.poses, {}, g.config).poses[1].matrix(), g.poses[1].matrix()) << "nothing known: it stays";
  }
}

}  // namespace
}  // namespace enamel::pipeline
