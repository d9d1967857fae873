// One pass of ICP over samples of a ball that lie exactly on its coarse view.
#include "pipeline/register/icp/accumulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/register/synthetic_surface.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr int kStride = 8;  ///< 0.22 mm between pixels of the view
const Vec3d kCentre(0, 0, 50);
constexpr double kRadius_mm = 4;

/// Of the camera's ray through a pixel. NaN: it misses.
Vec3d on_ball(const calib::LensValues& lens, double u, double v) {
  const Vec3d ray = Vec3d((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1).normalized();
  const double along = ray.dot(kCentre), off2 = kCentre.squaredNorm() - along * along;
  return (along - std::sqrt(kRadius_mm * kRadius_mm - off2)) * ray;
}

ModelView view_of_ball(const calib::LensValues& lens) {
  ModelView view;
  view.T_model_cam = Pose::Identity();
  view.stride = kStride;
  view.points = Map<Vec3f>(lens.width / kStride, lens.height / kStride, Vec3f::Zero());
  view.normals = view.points;
  for (int j = 0; j < view.points.height(); ++j) {
    for (int i = 0; i < view.points.width(); ++i) {
      const Vec3d p = on_ball(lens, i * kStride, j * kStride);
      view.points(i, j) = p.cast<float>();
      view.normals(i, j) = ((p - kCentre) / kRadius_mm).cast<float>();
    }
  }
  view.empty = false;
  return view;
}

SampleSet samples_of_ball(const calib::LensValues& lens) {
  SampleSet out;
  for (int v = 0; v < lens.height; v += 3) {
    for (int u = 0; u < lens.width; u += 3) {
      const Vec3d p = on_ball(lens, u, v);
      const Vec3f n = ((p - kCentre) / kRadius_mm).cast<float>();
      if (!(n.z() < -0.5F)) continue;  // steeper than 60 degrees, or beside the ball
      out.x.push_back(static_cast<float>(p.x())), out.nx.push_back(n.x());
      out.y.push_back(static_cast<float>(p.y())), out.ny.push_back(n.y());
      out.z.push_back(static_cast<float>(p.z())), out.nz.push_back(n.z());
      out.weights.push_back(1);
    }
  }
  out.centroid = kCentre;
  return out;
}

TEST(Accumulate, lays_a_bent_surface_on_its_coarse_view_without_a_bias) {
  const calib::LensValues lens = ts::test_rig(1).camera;
  ReferenceConfig config;
  config.pitch_mm = 0.01;  // not thinned
  const Reference reference(view_of_ball(lens), config);
  SampleSet samples = samples_of_ball(lens);
  const ViewCamera camera(lens);
  const MatchGate gate{0.3F, 0.5F, 0.7F, 0.5F};
  const AlignPass pass = accumulate({samples, reference, camera, 4.5}, Pose::Identity(), gate, {});
  ASSERT_GT(pass.matches, 4'000U);
  EXPECT_LT(1e3 * pass.rms_mm(), 0.5);

  // The control: normals that the view's own are replaced by for its distance to be that of its tangent planes.
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2f px = camera.project({samples.x[i], samples.y[i], samples.z[i]}) / kStride;
    const Reference::Pixel& nearest = reference.pixel(static_cast<std::size_t>(
        static_cast<int>(px.y() + 0.5F) * reference.width() + static_cast<int>(px.x() + 0.5F)));
    samples.nx[i] = nearest.normal.x(), samples.ny[i] = nearest.normal.y(), samples.nz[i] = nearest.normal.z();
  }
  const AlignPass tangent = accumulate({samples, reference, camera, 4.5}, Pose::Identity(), gate, {});
  EXPECT_GT(1e3 * tangent.rms_mm(), 1.0);
}

}  // namespace
}  // namespace enamel::pipeline
