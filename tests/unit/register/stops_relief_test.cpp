// Table and holder taken out of a scan: the model stays.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pipeline/register/stops/table_relief.hpp"
#include "tests/unit/register/stops_scene.hpp"

namespace enamel::pipeline {
namespace {

namespace ts = ::enamel::testing;

constexpr double kHoleX_mm = 3, kHoleRadius_mm = 4, kHigh_mm = 2;

/// The table's top, square to the rotation axis through the axes' crossing; on request a model on it: a disc.
class FlatTable {
 public:
  explicit FlatTable(std::uint64_t seed) : mount(ts::drawn_mount(seed)) {
    up_ = -ts::vec(mount.rotation.direction);
    if (up_.z() > 0) up_ = -up_;
    foot_ = ts::vec(mount.rotation.point_mm);
  }

  /// Height over `foot_`, 0 or kHigh_mm. `count`: pixels that see the model.
  [[nodiscard]] SurfacePatch patch(const Pose& T_model_cam, bool with_model, std::size_t& count) const {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    SurfacePatch out;
    out.depth_mm = Map<float>(rig.camera.width, rig.camera.height, kNan);
    out.sigma_mm = Map<float>(rig.camera.width, rig.camera.height, 0.008F);
    out.points = Map<Vec3f>(rig.camera.width, rig.camera.height, Vec3f::Constant(kNan));
    out.normals = Map<Vec3f>(rig.camera.width, rig.camera.height, Vec3f(0, 0, -1));
    count = 0;
    for (int v = 0; v < rig.camera.height; ++v) {
      for (int u = 0; u < rig.camera.width; ++u) {
        const Vec3d ray = ts::pixel_ray(rig.camera, u, v);
        const bool on_model = with_model && is_model(T_model_cam, ray);
        const double z = meets(T_model_cam, ray, on_model ? kHigh_mm : 0);
        const std::size_t i = out.depth_mm.index(u, v);
        out.depth_mm[i] = static_cast<float>(z);
        out.points[i] = (z * ray).cast<float>();
        count += on_model ? 1 : 0;
        ++out.valid_px;
      }
    }
    return out;
  }
  [[nodiscard]] double height_mm(const Vec3d& p_model) const { return up_.dot(p_model - foot_); }

  calib::Mount mount;
  calib::Rig rig = ts::test_rig(4);

 private:
  [[nodiscard]] double meets(const Pose& T, const Vec3d& ray, double height) const {
    return (height - height_mm(T.translation())) / up_.dot(T.linear() * ray);
  }
  [[nodiscard]] bool is_model(const Pose& T, const Vec3d& ray) const {
    const Vec3d p = T * (meets(T, ray, kHigh_mm) * ray), middle(kHoleX_mm, 0, 48);
    return up_.cross(p - middle).norm() < kHoleRadius_mm;
  }
  Vec3d up_, foot_;
};

TEST(TableRelief, an_empty_table_is_taken_out_and_the_model_kept) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const FlatTable table(seed);
    TableRelief relief(table.mount, {});
    EXPECT_TRUE(relief.empty());
    for (int k = 0; k < 15; ++k) {  // swung either way, the field is wider than what is asked below
      std::size_t none = 0;
      const Pose T = pose_by_axes(table.mount, ts::angles_deg(5.0 * (k % 5) - 10, k < 5 ? -8 : (k < 10 ? 0 : 8)));
      relief.add(table.patch(T, false, none), T);
    }
    EXPECT_FALSE(relief.empty());
    const Pose T = pose_by_axes(table.mount, ts::angles_deg(ts::drawn_in(seed, -8, 8), 4));
    std::size_t of_model = 0;
    SurfacePatch seen = table.patch(T, true, of_model);
    const std::size_t before = seen.valid_px;
    ASSERT_GT(of_model, 1000U);
    const std::size_t out = relief.take_out(T, seen);
    EXPECT_EQ(out, before - of_model) << seed;
    EXPECT_EQ(seen.valid_px, of_model);
    for (std::size_t i = 0; i < seen.depth_mm.size(); ++i) {
      EXPECT_EQ(std::isnan(seen.depth_mm[i]), std::isnan(seen.normals[i].x()));
      EXPECT_EQ(std::isnan(seen.depth_mm[i]), std::isnan(seen.sigma_mm[i]));
    }
    // Negative control: a relief that saw nothing takes nothing out.
    SurfacePatch again = table.patch(T, true, of_model);
    EXPECT_EQ(TableRelief(table.mount, {}).take_out(T, again), 0U);
  }
}

TEST(TableRelief, a_plane_takes_out_what_is_lower) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const FlatTable table(seed);
    const Pose T = pose_by_axes(table.mount, ts::angles_deg(0, 0));
    const Vec3d probe(1, 2, 47);
    const double datum = table.height_mm(probe) - TableRelief(table.mount, {}).height_mm(probe);
    std::size_t of_model = 0;
    SurfacePatch seen = table.patch(T, true, of_model);
    const std::size_t before = seen.valid_px;
    const TableRelief between(table.mount, {}, 0.5 * kHigh_mm - datum);
    EXPECT_FALSE(between.empty());
    EXPECT_EQ(between.take_out(T, seen), before - of_model) << seed;
    EXPECT_EQ(TableRelief(table.mount, {}, -5).take_out(T, seen), 0U) << "all is higher";
    EXPECT_EQ(TableRelief(table.mount, {}, 5).take_out(T, seen), of_model) << "all is lower";
    EXPECT_EQ(seen.valid_px, 0U);
  }
}

TEST(TableRelief, heights_count_towards_the_camera) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    calib::Mount m = ts::drawn_mount(seed);
    const double here = TableRelief(m, {}).height_mm({0, 0, 48});
    EXPECT_GT(TableRelief(m, {}).height_mm({0, 0, 40}), here + 7);
    for (double& d : m.rotation.direction) d = -d;  // the same line, its sense the other way
    EXPECT_NEAR(TableRelief(m, {}).height_mm({0, 0, 48}), here, 1e-9);
    m.swing.direction = m.rotation.direction;  // no crossing: nothing to divide by
    EXPECT_TRUE(std::isfinite(TableRelief(m, {}).height_mm({0, 0, 48})));
  }
}

}  // namespace
}  // namespace enamel::pipeline
