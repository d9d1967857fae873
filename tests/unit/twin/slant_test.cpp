// Light inside at a slant: what photons do by the directions of light and view, and that the renderer does the same.
#include "tests/unit/twin/slab_scene.hpp"
#include "tests/unit/twin/slant_photons.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary

constexpr double kIndex = 1.63;
using Slant = PhotonWalk::Slant;

/// Contrast, and shift over the difference of the directions' parts along the surface, by photons: light from straight
/// above, seen from both sides, so that chance sidesteps cancel.
std::vector<SlantResponse> facing_photons(const std::vector<double>& periods_mm, std::uint64_t seed) {
  constexpr double kSine = 0.7;
  const auto seen = slant_responses({{}, seed}, {}, periods_mm, {{-kSine, 0}, {kSine, 0}}, 8000);
  std::vector<SlantResponse> out;
  for (std::size_t p = 0; p < periods_mm.size(); ++p) {
    out.push_back({(seen[0][p].modulation + seen[1][p].modulation) / 2,
                   (seen[0][p].shift_mm - seen[1][p].shift_mm) / (2 * kSine)});
  }
  return out;
}

double tangent_inside(double sine) { return sine / std::sqrt(kIndex * kIndex - sine * sine); }

TEST(SlantPhotons, shift_fringes_by_the_sines_of_light_and_view) {
  // Eight thousand photons scatter by 0.01 of the contrast and 5 % of the shift. Of light and view at 72 degrees the
  // contrast is a tenth higher and the shift as much less: k is the same.
  const std::vector<double> periods{0.75, 1.5, 3.0};
  const Slant light{0.95, 0};
  const std::vector<Slant> views{{-0.95, 0}, {-0.5, 0}, {-0.5, 0.7}};
  const auto facing = facing_photons(periods, 11);
  const auto steep = slant_responses({{}, 12}, light, periods, views, 8000);
  double by_sines = 0, by_tangents = 0;
  for (std::size_t p = 0; p < periods.size(); ++p) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const double per_sine_mm = steep[v][p].shift_mm / (light.x - views[v].x);
      EXPECT_NEAR(per_sine_mm / facing[p].shift_mm, 1, 0.25) << periods[p] << " " << v;
      EXPECT_NEAR(steep[v][p].modulation, facing[p].modulation, 0.065) << periods[p] << " " << v;
    }
    const double each = 1 / static_cast<double>(periods.size());
    const double per_tangent_mm = steep[0][p].shift_mm / (2 * tangent_inside(0.95));
    by_sines += each * steep[0][p].shift_mm / (2 * 0.95) / facing[p].shift_mm;
    by_tangents += each * per_tangent_mm / (facing[p].shift_mm * 0.7 / tangent_inside(0.7));
  }
  EXPECT_NEAR(by_sines, 1, 0.1);
  EXPECT_LT(by_tangents, 0.94);  // control: rays bent down to one depth
}

/// Of the pixel in the middle of a slab: directions of light and view along its surface, model x, y, and the wave
/// vector of the fringes there, rad / mm.
struct Geometry {
  Eigen::Vector2d light, view, wave;
  [[nodiscard]] double period_mm() const { return 2 * kPi / wave.norm(); }
  [[nodiscard]] double apart() const { return wave.dot(light - view); }
  [[nodiscard]] double apart_by_tangents() const {
    const auto bent = [](const Eigen::Vector2d& s) { return Eigen::Vector2d(s / s.norm() * tangent_inside(s.norm())); };
    return kIndex * wave.dot(bent(light) - bent(view));
  }
};

Geometry geometry_of(const SceneConfig& scene, const calib::Rig& rig) {
  const Pose pose = source_of(scene, rig)->poses(0).mid;
  const Eigen::Isometry3d to_projector = T_proj_cam(rig) * pose.inverse();
  const Eigen::Vector3d at = pose * plane_point(rig, pose, rig.camera.cx, rig.camera.cy);
  const auto towards = [&](const Eigen::Vector3d& eye) { return Eigen::Vector2d((eye - at).normalized().head<2>()); };
  const auto phase = [&](double x, double y) {
    const Eigen::Vector3d p = to_projector * (at + Eigen::Vector3d(x, y, 0));
    return 2 * kPi * project(rig.projector, p).x() / rig.patterns.period_px;
  };
  constexpr double kStep = 1e-3;
  Geometry g;
  g.light = towards(to_projector.inverse().translation());
  g.view = towards(pose.translation());
  g.wave = Eigen::Vector2d(phase(kStep, 0) - phase(-kStep, 0), phase(0, kStep) - phase(0, -kStep)) / (2 * kStep);
  return g;
}

struct Rendered {
  double modulation = 0, shift_rad = 0;
  Geometry geometry;
};

Rendered rendered_at(double tilt_x_deg, double tilt_y_deg, double period_mm) {
  const calib::Rig rig = rig_with_period(period_mm);
  SceneConfig scene = slab_of(MaterialId::kEnamel, 0);
  scene.views[0].tilt_x_deg = tilt_x_deg;
  scene.views[0].tilt_y_deg = tilt_y_deg;
  Rendered out;
  out.geometry = geometry_of(scene, rig);
  const Fringe seen = fringe_of(scene, rig);
  scene.look.material = 0;
  const Fringe plaster = fringe_of(scene, rig);
  out.modulation = seen.modulation / plaster.modulation;
  out.shift_rad = mean_shift(seen, plaster);
  return out;
}

TEST(TwinTranslucency, follows_photons_at_every_slant) {
  const std::vector<std::pair<double, double>> tilts_deg{{0, 0},  {0, -60}, {0, -45}, {0, 30},
                                                         {0, 60}, {45, 0},  {30, 30}};
  std::vector<Rendered> seen;
  std::vector<double> periods_mm;
  for (const auto& [x, y] : tilts_deg) {
    seen.push_back(rendered_at(x, y, 0.73));
    periods_mm.push_back(seen.back().geometry.period_mm());
  }
  const auto photons = facing_photons(periods_mm, 22);
  double worst_by_tangents = 0;
  for (std::size_t i = 1; i < seen.size(); ++i) {
    const Geometry &here = seen[i].geometry, &facing = seen[0].geometry;
    EXPECT_NEAR(seen[i].modulation / photons[i].modulation, 1, 0.12) << i;
    const double grown = photons[i].shift_mm / photons[0].shift_mm, shift = seen[i].shift_rad / seen[0].shift_rad;
    EXPECT_NEAR(shift / (grown * here.apart() / facing.apart()), 1, 0.2) << i;
    const double by_tangents = grown * here.apart_by_tangents() / facing.apart_by_tangents();
    worst_by_tangents = std::max(worst_by_tangents, by_tangents / shift);
  }
  EXPECT_GT(worst_by_tangents, 1.35);  // control: rays bent down to one depth
}

TEST(TwinTranslucency, no_period_between_the_octaves_stands_out) {
  // k = M d / (1 - M) of photons grows as the period to the power of 1.75 from 0.5 to 6 mm, that of the table's octaves
  // as 1.65 to 2; the twin's octave from 0.73 to 1.1 mm used to grow as 2.2.
  const auto k_at = [](double period_mm) {
    const Rendered r = rendered_at(0, 0, period_mm);
    const double reach_mm = r.shift_rad / r.geometry.apart();
    return r.modulation * reach_mm / (1 - r.modulation);
  };
  double before_mm = 0.5, before = k_at(before_mm);
  for (const double period_mm : {0.6, 0.73, 0.9, 1.1, 1.5, 2.0, 3.0, 4.0}) {
    const double k = k_at(period_mm), growth = std::log(k / before) / std::log(period_mm / before_mm);
    EXPECT_GT(growth, 1.5) << period_mm;
    EXPECT_LT(growth, 2.05) << period_mm;
    before_mm = period_mm, before = k;
  }
}

}  // namespace
}  // namespace enamel::twin
