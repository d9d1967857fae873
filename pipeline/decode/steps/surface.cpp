#include "pipeline/decode/steps/surface.hpp"

#include <vector>

#include "pipeline/decode/phase/row_memory.hpp"
#include "pipeline/decode/steps/surface_rows.hpp"
#include "pipeline/decode/triangulate/interleave.hpp"

namespace enamel::pipeline {
namespace {

RippleTerms terms_of(const PhaseRipple& ripple) {
  RippleTerms out;
  for (std::size_t m = 0; m < kRippleTerms; ++m) {
    out.cosine[m] = static_cast<float>(ripple.cosine[m]);
    out.sine[m] = static_cast<float>(ripple.sine[m]);
  }
  return out;
}

SurfaceRow row_of(const PhaseMaps& m, const Map<std::int16_t>& wraps, const RayDepth& r, std::size_t at) {
  return {&m.phase_rad[at], &m.cosine_dn[at],     &m.sine_dn[at], &m.sigma_rad[at], &wraps[at],
          &m.reject[at],    &r.phase_mid_rad[at], &r.c0[at],      &r.c1[at],        &r.c2[at],
          &r.c3[at],        &r.rays.x[at],        &r.rays.y[at]};
}

}  // namespace

void make_surface(const RefinedPhase& phase, const RayDepth& rays, const PhaseRipple& ripple,
                  const NormalConfig& config, std::vector<float>& scratch, DecodedBurst& out) {
  const RippleTerms terms = terms_of(ripple);
  const InverseDepthRange range = depth_range_of(rays);
  const auto width = static_cast<std::size_t>(rays.width);
  RowMemory x(width), y(width);
  SurfacePatch& patch = out.patch;
  NormalRows normals(rays, config, scratch);
  for (int v = 0; v < rays.height; ++v) {
    const std::size_t at = static_cast<std::size_t>(v) * width;
    solve_surface_row(row_of(phase.maps, phase.wraps, rays, at), range, terms, width,
                      {normals.row(v), &patch.depth_mm[at], &patch.sigma_mm[at], &out.phase_rad[at], &out.order[at],
                       &out.reject[at], x.data(), y.data()});
    interleave(x.data(), y.data(), &patch.depth_mm[at], width, patch.points[at].data());
    normals.added(v, patch.sigma_mm, patch.normals);
  }
}

}  // namespace enamel::pipeline
