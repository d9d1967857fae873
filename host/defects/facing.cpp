#include "host/defects/detect.hpp"

namespace enamel::host::defects {

std::optional<Facing> facing_about(const Surface& s, const Vec3d& about, double reach_mm) {
  constexpr int kRounds = 4;
  constexpr double kOneWay = 0.8;    // of the sum of normals, else they face all ways
  constexpr double kSameWay = 0.94;  // derived: cos 20 deg, what faces farther off is a wall beside the top
  Facing out;
  for (int i = 0; i < kRounds; ++i) {
    Vec3d normal = Vec3d::Zero(), middle = Vec3d::Zero();
    double area = 0;
    for (std::uint32_t c = 0; c < s.cells.size(); ++c) {
      const Vec3d p = place_of(s, c), n = s.mesh.normals[s.cells.vertex[c]].cast<double>();
      if ((p - about).norm() > reach_mm || (i > 0 && n.dot(out.axis) < kSameWay)) continue;
      normal += s.cells.area_mm2[c] * n;
      middle += s.cells.area_mm2[c] * p;
      area += s.cells.area_mm2[c];
    }
    if (!(area > 0) || normal.norm() < kOneWay * area) return std::nullopt;
    out.axis = normal.normalized();
    out.middle = middle / area;
  }
  return out;
}

}  // namespace enamel::host::defects
