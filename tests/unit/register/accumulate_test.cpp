// One pass of ICP over samples of a ball that lie exactly on its coarse view.
#include "pipeline/register/icp/accumulate.hpp"

#include <gtest/gtest.h>

#include "pipeline/register/icp/patch_view.hpp"
#include "tests/unit/model/synthetic.hpp"

namespace enamel::pipeline {
namespace {

constexpr int kStride = 8;  ///< 0.22 mm between pixels of the view

TEST(Accumulate, lays_a_bent_surface_on_its_coarse_view_without_a_bias) {
  calib::Rig rig = synthetic::rig();
  rig.camera.dist = {};  // the view's pixels are the patch's
  const Pose pose = Pose::Identity();
  const SurfacePatch patch = synthetic::render(rig, synthetic::sphere({0, 0, 50}, 4), pose);
  ReferenceConfig config;
  config.pitch_mm = 0.01;  // not thinned
  const Reference reference(view_from_patch(patch, pose, rig.camera, kStride), config);
  SampleSet samples = sample_patch(patch, 3, {});
  const ViewCamera camera(rig.camera);
  const MatchGate gate{0.3F, 0.5F, 0.7F, 0.5F};
  const AlignPass pass = accumulate({samples, reference, camera, 4.5}, pose, gate, {});
  ASSERT_GT(pass.matches, 4'000U);
  EXPECT_LT(1e3 * pass.rms_mm(), 0.5);

  // The control: normals that the view's own are replaced by for its distance to be that of its tangent planes.
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec2f px = camera.project({samples.x[i], samples.y[i], samples.z[i]}) / kStride;
    const Reference::Pixel& nearest = reference.pixel(static_cast<std::size_t>(
        static_cast<int>(px.y() + 0.5F) * reference.width() + static_cast<int>(px.x() + 0.5F)));
    samples.nx[i] = nearest.normal.x(), samples.ny[i] = nearest.normal.y(), samples.nz[i] = nearest.normal.z();
  }
  const AlignPass tangent = accumulate({samples, reference, camera, 4.5}, pose, gate, {});
  EXPECT_GT(1e3 * tangent.rms_mm(), 1.0);
}

}  // namespace
}  // namespace enamel::pipeline
