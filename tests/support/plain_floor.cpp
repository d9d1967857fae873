#include "tests/support/plain_floor.hpp"

#include <cmath>

#include "calib/model/lens.hpp"

namespace enamel::test {

Map<std::uint8_t> depth_edges(const Map<float>& depth_mm) {
  const int w = depth_mm.width(), h = depth_mm.height();
  Map<std::uint8_t> out(w, h);
  const auto compare = [&](std::size_t a, std::size_t b) {
    const bool none_a = std::isnan(depth_mm[a]), none_b = std::isnan(depth_mm[b]);
    if (none_a && none_b) return;
    if (none_a || none_b || std::abs(depth_mm[a] - depth_mm[b]) > kDepthEdge_mm) out[a] = out[b] = 1;
  };
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      if (u + 1 < w) compare(depth_mm.index(u, v), depth_mm.index(u + 1, v));
      if (v + 1 < h) compare(depth_mm.index(u, v), depth_mm.index(u, v + 1));
    }
  }
  return out;
}

Floor floor_of(const calib::Rig& rig, const DepthTruth& truth, const Map<float>& depth_mm) {
  Floor out;
  const auto near_mm = static_cast<float>(rig.depth_range->near_mm);
  const auto far_mm = static_cast<float>(rig.depth_range->far_mm);
  for (int v = 0; v < depth_mm.height(); ++v) {
    for (int u = 0; u < depth_mm.width(); ++u) {
      const float z = depth_mm(u, v), true_z = truth.depth_mm(u, v);
      if (!(true_z >= near_mm && true_z <= far_mm)) continue;
      const bool lit = truth.lit(u, v) != 0;
      out.lit += lit ? 1U : 0U;
      if (std::isnan(z)) continue;
      out.covered += lit ? 1U : 0U;
      ++out.placed;
      const calib::PlanePoint ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
      const double off_px = calib::project_to_projector(rig, ray, static_cast<double>(z)).x -
                            calib::project_to_projector(rig, ray, static_cast<double>(true_z)).x;
      out.wrong += std::abs(off_px) > rig.patterns.period_px / 2 ? 1U : 0U;
    }
  }
  return out;
}

BesidePlain beside_plain(const calib::Rig& rig, const DepthTruth& truth, const Map<float>& product_mm,
                         const Map<float>& plain_mm) {
  BesidePlain out{floor_of(rig, truth, product_mm), floor_of(rig, truth, plain_mm)};
  for (std::size_t i = 0; i < truth.lit.size() && !out.edges; ++i) out.edges = truth.lit[i] != 0 && truth.edge[i] != 0;
  return out;
}

}  // namespace enamel::test
