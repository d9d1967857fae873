// The mount's covariance with a rig that was solved, not given: errors of the lines in their own sigmas, over drawn
// units whose rigs are off by draws from their covariance.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "calib/mount/mount_solve.hpp"
#include "calib/mount/rig_uncertainty.hpp"
#include "calib/solve/bundle.hpp"
#include "calib/solve/projection.hpp"
#include "tests/unit/calib/drawn_mount_set.hpp"

namespace enamel::calib {
namespace {

constexpr std::uint64_t kUnits = 12;
constexpr int kComponents = 8;

/// Sigmas of some tenths of a pixel, as a rig of few poses has them, and correlations drawn by seed.
Eigen::MatrixXd drawn_covariance(std::uint64_t seed) {
  Eigen::VectorXd sigma(kRigParameters);
  const double lens[8] = {0.3, 0.3, 0.2, 0.2, 3e-4, 1e-3, 5e-5, 5e-5};
  for (int k = 0; k < 16; ++k) sigma[k] = lens[k % 8];
  sigma.tail<6>() << 1e-4, 1e-4, 1e-4, 5e-3, 5e-3, 5e-3;
  Rng rng(seed, 0, 29);
  Eigen::MatrixXd mix(kRigParameters, 2 * kRigParameters);
  for (Eigen::Index k = 0; k < mix.size(); ++k) mix.data()[k] = rng.normal();
  Eigen::MatrixXd c = mix * mix.transpose();
  const Eigen::VectorXd scale = sigma.cwiseQuotient(c.diagonal().cwiseSqrt());
  return scale.asDiagonal() * c * scale.asDiagonal();
}

RigState disturbed(RigState rig, const Eigen::MatrixXd& covariance, std::uint64_t seed) {
  Rng rng(seed, 0, 31);
  Eigen::VectorXd z(kRigParameters);
  for (double& value : z) value = rng.normal();
  const Eigen::VectorXd off = Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * z;
  Eigen::Index at = 0;
  for (LensValues* lens : {&rig.camera, &rig.projector}) {
    LensBlock b = block_of(*lens);
    for (std::size_t k = 0; k < 8; ++k) b[k] += off[at++];
    set_lens(*lens, b);
  }
  MotionBlock relative = block_of(rig.T_proj_cam);
  for (double& value : relative) value += off[at++];
  rig.T_proj_cam = pose_of(relative);
  return rig;
}

/// Errors of both lines across themselves, whitened by the mount's own covariance: normal, independent, if that is
/// true.
Eigen::VectorXd in_sigmas(const Mount& solved, const Drawn& truth) {
  Eigen::MatrixXd across = Eigen::MatrixXd::Zero(kComponents, static_cast<Eigen::Index>(kMountParameters));
  Eigen::VectorXd error(kComponents);
  const std::pair<const AxisLine*, const AxisLine*> lines[] = {{&solved.rotation, &truth.rotation},
                                                               {&solved.swing, &truth.swing}};
  for (Eigen::Index n = 0; n < 2; ++n) {
    const auto& [ours, theirs] = lines[n];
    const Vec3d d(ours->direction.data()), e1 = d.unitOrthogonal(), e2 = d.cross(e1);
    const Triple place = nearest_to_origin(*ours), true_place = nearest_to_origin(*theirs);
    const Vec3d off[2] = {d - Vec3d(theirs->direction.data()), Vec3d(place.data()) - Vec3d(true_place.data())};
    for (Eigen::Index part = 0; part < 2; ++part) {
      across.block<1, 3>(4 * n + 2 * part, 8 * n + 3 * part) = e1.transpose();
      across.block<1, 3>(4 * n + 2 * part + 1, 8 * n + 3 * part) = e2.transpose();
      error[4 * n + 2 * part] = e1.dot(off[part]);
      error[4 * n + 2 * part + 1] = e2.dot(off[part]);
    }
  }
  const auto size = static_cast<Eigen::Index>(kMountParameters);
  const Eigen::MatrixXd c =
      across * Eigen::Map<const Eigen::MatrixXd>(solved.covariance.matrix.data(), size, size) * across.transpose();
  return Eigen::LLT<Eigen::MatrixXd>(c).matrixL().solve(error);
}

/// Fewest of n within two sigmas that a true covariance falls below once in a thousand sets.
int fewest_within(int n) {
  const double p = std::erf(2 / std::sqrt(2.0));
  double below = 0;
  int k = 0;
  for (; k <= n; ++k) {
    const double log_ways = std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
    below += std::exp(log_ways + k * std::log(p) + (n - k) * std::log1p(-p));
    if (below > 1e-3) break;
  }
  return k;
}

struct Count {
  int all = 0, within = 0, within_without = 0;
};

Count count(bool has_fringes) {
  const TargetDesign target = points(16, 4.5);
  DrawnStops asked{.angles_deg = every(12, {0}), .has_fringes = has_fringes};
  for (const double swing : {-20.0, -10.0, 10.0, 20.0})
    for (const double rotation : {0.0, 120.0, 240.0}) asked.angles_deg.push_back({rotation, swing});
  Count out;
  for (std::uint64_t seed = 1; seed <= kUnits; ++seed) {
    const Eigen::MatrixXd covariance = drawn_covariance(seed);
    const Drawn unit = draw(seed, target, rig(), asked);
    const RigState solved = disturbed(rig(), covariance, seed);
    for (const bool is_told : {true, false}) {
      const MountOptions options{.rig_covariance = is_told ? covariance : Eigen::MatrixXd()};
      const auto s = solve_mount(unit.stops, target, solved, options);
      EXPECT_TRUE(s) << s.error().message();
      if (!s) continue;
      EXPECT_EQ(s->has_rig_share, is_told);
      const auto inside = static_cast<int>((in_sigmas(s->mount, unit).array().abs() <= 2).count());
      (is_told ? out.within : out.within_without) += inside;
      if (!is_told) continue;
      out.all += kComponents;
      EXPECT_GT(s->rotation.place_mm, s->rotation_by_pictures.place_mm);
    }
  }
  return out;
}

class MountRigShare : public testing::TestWithParam<bool> {};

TEST_P(MountRigShare, holds_the_lines_errors_within_two_sigmas) {
  const Count n = count(GetParam());
  std::printf("within 2 sigma: %d of %d, without the rig's share %d; at least %d\n", n.within, n.all, n.within_without,
              fewest_within(n.all));
  EXPECT_GE(n.within, fewest_within(n.all));
  EXPECT_LT(n.within_without, fewest_within(n.all)) << "negative control: the rig taken for perfect";
}

TEST(RigCovariance, is_taken_only_where_it_is_one) {
  const auto with = [](const Eigen::MatrixXd& matrix, const char* first) {
    nlohmann::json names = nlohmann::json::array(), rows = nlohmann::json::array();
    for (const char* name : rig_parameter_names()) names.push_back(name);
    names[0] = first;
    for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
      const Eigen::VectorXd row = matrix.row(r);
      rows.push_back(std::vector<double>(row.begin(), row.end()));
    }
    Rig rig;
    rig.text = nlohmann::json{{"covariance", {{"parameters", names}, {"matrix", rows}}}}.dump();
    return rig_covariance_of(rig);
  };
  const Eigen::MatrixXd good = drawn_covariance(5);
  EXPECT_LT((with(good, "camera.fx") - good).norm(), 1e-12);
  EXPECT_EQ(with(good, "camera.fy").size(), 0) << "other parameters";
  Eigen::MatrixXd bad = good;
  bad(0, 1) = bad(1, 0) = 2 * std::sqrt(good(0, 0) * good(1, 1));
  EXPECT_EQ(with(bad, "camera.fx").size(), 0) << "a correlation of two";
  EXPECT_EQ(with(-good, "camera.fx").size(), 0);
  EXPECT_EQ(rig_covariance_of(Rig{}).size(), 0);
}

INSTANTIATE_TEST_SUITE_P(BothWays, MountRigShare, testing::Values(false, true),
                         [](const auto& way) { return way.param ? "with_fringes" : "camera_alone"; });

}  // namespace
}  // namespace enamel::calib
