// The mixed metric: its closest points against brute force, its normal equations against motions that are known.
#include "pipeline/register/icp/mixed_metric.hpp"

#include <gtest/gtest.h>

#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr double kRho_mm = 4.5;
constexpr MatchGate kGate{1, 1, 0.7F, 0.5F};
/// Every match counts alike.
constexpr RobustKernel kNoKernel{false, 0};

/// The analytic surface, or the plane, from straight above; columns beyond `columns` are cut off.
struct MetricScene {
  calib::LensValues lens = ts::test_rig().camera;
  ViewCamera camera{lens};
  Reference reference;

  explicit MetricScene(double relief, int columns = 1 << 20) {
    ModelView view = ts::make_view(ts::SyntheticSurface(7, relief), lens, ts::looking_down(0, 0));
    for (int v = 0; v < view.points.height(); ++v) {
      for (int u = columns; u < view.points.width(); ++u) view.points(u, v).setConstant(std::nanf(""));
    }
    reference = Reference(view, {});
  }
};

/// Every usable pixel that `take` agrees to becomes a sample, in the frame that `T_model_cam` takes to the model.
template <class Take>
SampleSet samples_of(const Reference& reference, const Pose& T_model_cam, Take take) {
  SampleSet out;
  const Pose T_cam_model = T_model_cam.inverse();
  for (int v = 0; v < reference.height(); ++v) {
    for (int u = 0; u < reference.width(); ++u) {
      const auto& pixel = reference.pixel(static_cast<std::size_t>(v * reference.width() + u));
      if (!std::isfinite(pixel.point.x()) || !take(u, v)) continue;
      const Vec3f p = (T_cam_model * pixel.point.cast<double>()).cast<float>();
      const Vec3f n = (T_cam_model.linear() * pixel.normal.cast<double>()).cast<float>();
      out.x.push_back(p.x()), out.y.push_back(p.y()), out.z.push_back(p.z());
      out.nx.push_back(n.x()), out.ny.push_back(n.y()), out.nz.push_back(n.z());
      out.weights.push_back(1);
      out.centroid += p.cast<double>();
    }
  }
  out.centroid /= static_cast<double>(out.size());
  return out;
}

Vector6 drawn_motion(std::uint64_t seed, double turn_rad, double shift_mm) {
  Vector6 x;
  for (std::uint64_t k = 0; k < 6; ++k) x[static_cast<Eigen::Index>(k)] = ts::normal(60 * seed + k);
  x.head<3>() *= turn_rad * kRho_mm / x.head<3>().norm();
  x.tail<3>() *= shift_mm / x.tail<3>().norm();
  return x;
}

TEST(MixedMetric, closest_points_are_those_of_brute_force) {
  const MetricScene scene(1);
  const Reference& reference = scene.reference;
  const ClosestPoints closest(reference, scene.camera, {true, true});
  const Pose T_cam_model = reference.T_model_cam().inverse();
  const auto pixels = static_cast<std::size_t>(reference.width() * reference.height());
  constexpr float kReach = 0.5F;
  int matched = 0, not_on_ray = 0;
  for (std::uint64_t k = 0; k < 200; ++k) {
    const std::size_t near = ts::mix(k) % pixels;
    Vec3f p = reference.pixel(near).point;
    if (!std::isfinite(p.x())) continue;
    for (int i = 0; i < 3; ++i) p[i] += 0.4F * static_cast<float>(ts::normal(10 * k + static_cast<std::uint64_t>(i)));
    const Vec3f in_view = (T_cam_model * p.cast<double>()).cast<float>();
    const auto match = closest.match(in_view, p, kReach);
    if (match.on_ray == ClosestPoints::kNone) continue;
    float least = kReach * kReach;
    for (std::size_t i = 0; i < pixels; ++i) {
      const float d2 = (reference.pixel(i).point - p).squaredNorm();
      if (d2 < least) least = d2;
    }
    if (match.pixel == ClosestPoints::kNone) {
      EXPECT_FLOAT_EQ(least, kReach * kReach) << k;
      continue;
    }
    ++matched;
    not_on_ray += match.pixel != match.on_ray;
    EXPECT_EQ((reference.pixel(static_cast<std::size_t>(match.pixel)).point - p).squaredNorm(), least) << k;
  }
  EXPECT_GT(matched, 60);
  EXPECT_GT(not_on_ray, matched / 2);  // the control: the ray's own pixel is another one
}

/// Points that lie on pixels, moved by less than they are apart: the point term finds the whole motion in one step,
/// even on a plane, which leaves the plane term three directions free.
TEST(MixedMetric, the_point_term_finds_motions_that_a_plane_leaves_free) {
  const MetricScene plane(0);
  const ClosestPoints closest(plane.reference, plane.camera, {});
  const Pose truth = plane.reference.T_model_cam();
  const auto inner = [&](int u, int v) {
    return u > 8 && v > 8 && u + 9 < plane.reference.width() && v + 9 < plane.reference.height();
  };
  const SampleSet samples = samples_of(plane.reference, truth, inner);
  const Alignment of{samples, plane.reference, plane.camera, kRho_mm};
  const Vec3d centre = truth * samples.centroid;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Vector6 away = drawn_motion(seed, 1e-3, 0.005);
    const Pose start = apply_motion(away, centre, kRho_mm, truth);
    const auto left = [&](double lambda) {
      const AlignPass pass = accumulate_mixed(of, {closest, lambda}, start, kGate, kNoKernel);
      EXPECT_EQ(pass.matches, samples.size());
      const Solution s = solve(pass.system, Vector6::Zero(), {});
      EXPECT_EQ(s.weak, lambda < 1 ? 0 : 3);
      const Vec3d c = start * samples.centroid;
      return motion_between(apply_motion(s.x, c, kRho_mm, start), truth, centre, kRho_mm).norm();
    };
    EXPECT_LT(left(0), 1e-3 * away.norm()) << seed;
    EXPECT_LT(left(0.3), 1e-3 * away.norm()) << seed;
    EXPECT_GT(left(1), 0.1 * away.norm()) << seed;
  }
}

TEST(MixedMetric, is_the_weighted_mean_of_both_terms) {
  const MetricScene scene(1);
  const ClosestPoints closest(scene.reference, scene.camera, {});
  const Pose truth = scene.reference.T_model_cam();
  const SampleSet samples = samples_of(scene.reference, truth, [](int u, int v) { return u % 4 == 0 && v % 4 == 0; });
  const Alignment of{samples, scene.reference, scene.camera, kRho_mm};
  const Pose start = apply_motion(drawn_motion(3, 0.02, 0.2), truth * samples.centroid, kRho_mm, truth);
  const auto pass = [&](double lambda) { return accumulate_mixed(of, {closest, lambda}, start, kGate, kNoKernel); };
  const AlignPass plane = pass(1), point = pass(0);
  ASSERT_GT(plane.matches, 1000U);
  for (const double lambda : {0.3, 0.7}) {
    const AlignPass mixed = pass(lambda);
    EXPECT_NEAR(mixed.weighted_e2, lambda * plane.weighted_e2 + (1 - lambda) * point.weighted_e2, 1e-9);
    EXPECT_NEAR(mixed.system.weight, plane.system.weight, 1e-6);
    const Matrix6 H = lambda * plane.system.H + (1 - lambda) * point.system.H;
    const Vector6 g = lambda * plane.system.g + (1 - lambda) * point.system.g;
    EXPECT_LT((mixed.system.H - H).norm(), 1e-9 * H.norm());
    EXPECT_LT((mixed.system.g - g).norm(), 1e-9 * g.norm());
  }
  EXPECT_GT((plane.system.H - point.system.H).norm(), 0.1 * plane.system.H.norm());
}

/// Half of the plane is known. What lies beyond has its closest point on the rim and would pull the patch over.
TEST(MixedMetric, matches_on_the_rim_are_left_out) {
  const MetricScene whole(0), half(0, 160);
  const Pose truth = half.reference.T_model_cam();
  const SampleSet samples = samples_of(whole.reference, truth, [](int, int) { return true; });
  const Alignment of{samples, half.reference, half.camera, kRho_mm};
  const auto pull = [&](bool rim) {
    const ClosestPoints closest(half.reference, half.camera, {true, rim});
    const AlignPass pass = accumulate_mixed(of, {closest, 0}, truth, kGate, kNoKernel);
    return solve(pass.system, Vector6::Zero(), {}).x.norm();
  };
  EXPECT_LT(pull(false), 1e-4);
  EXPECT_GT(pull(true), 0.02);
}

}  // namespace
}  // namespace enamel::pipeline
