#include "tools/twin/jaw/sphere_bar.hpp"

#include "tools/twin/degrees.hpp"
#include "tools/twin/surface/ball_bar.hpp"

namespace enamel::twin {

SphereBar make_sphere_bar(const SphereBarConfig& config, const ArchShape& shape, std::uint64_t seed) {
  SphereBar out;
  const Arch arch(shape);
  for (std::size_t i = 0; i < config.arc_mm.size(); ++i) {
    const double s = config.arc_mm[i];
    const Eigen::Vector2d at = arch.point(s) + config.offset_mm * arch.buccal(s);
    const double diameter = config.diameters_mm[config.diameters_mm.size() == 1 ? 0 : i];
    out.balls.push_back({Vec3d(at.x(), at.y(), config.height_mm), diameter / 2, static_cast<float>(config.albedo)});
    if (i == 0 || config.rod_diameter_mm == 0) continue;
    append(out.rods,
           ball_rod(out.balls[i - 1].centre, out.balls[i].centre, config.rod_diameter_mm / 2, out.balls[i].albedo));
  }
  out.certificate_json = ball_certificate(out.balls, kMmPerUm * config.sigma_um, seed);
  return out;
}

}  // namespace enamel::twin
