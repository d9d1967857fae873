#include "pipeline/algo/fuse/surfel_map.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::algo {
namespace {

// A second difference of three equal sigmas has std sqrt(6) sigma; 3.5 of those is noise, more is an edge.
constexpr float kBendLimit = 8.5F;

struct Average {
  float depth_mm;
  std::uint8_t support;
};

// Mean of three collinear depths, or the middle one where they bend or one is missing (comparisons with NaN are false).
inline Average average_of(float before, float here, float after, float sigma) noexcept {
  const bool flat = std::fabs((before + after) - 2.0F * here) < kBendLimit * sigma;
  const float mean = ((before + after) + here) * (1.0F / 3.0F);
  return {flat ? mean : here, static_cast<std::uint8_t>(flat ? 3 : 1)};
}

}  // namespace

void SurfelMap::average_rows(const SurfacePatch& patch) {
  const int w = patch.depth_mm.width();
  for (int v = 0; v < patch.depth_mm.height(); ++v) {
    const float* z = &patch.depth_mm(0, v);
    const float* sigma = &patch.sigma_mm(0, v);
    float* out = &along_rows_mm_(0, v);
    std::uint8_t* support = &row_support_(0, v);
    out[0] = z[0];
    support[0] = 1;
    out[w - 1] = z[w - 1];
    support[w - 1] = 1;
    for (int u = 1; u < w - 1; ++u) {
      const Average a = average_of(z[u - 1], z[u], z[u + 1], sigma[u]);
      out[u] = a.depth_mm;
      support[u] = a.support;
    }
  }
}

void SurfelMap::average_columns(const SurfacePatch& patch) {
  const int w = patch.depth_mm.width();
  const int h = patch.depth_mm.height();
  for (int v = 0; v < h; ++v) {
    const float* here = &along_rows_mm_(0, v);
    const float* above = v > 0 ? &along_rows_mm_(0, v - 1) : nullptr;
    const float* below = v + 1 < h ? &along_rows_mm_(0, v + 1) : nullptr;
    const float* sigma = &patch.sigma_mm(0, v);
    if (above == nullptr || below == nullptr) {
      std::copy(here, here + w, &smooth_mm_(0, v));
      std::copy(&row_support_(0, v), &row_support_(0, v) + w, &support_(0, v));
      continue;
    }
    for (int u = 0; u < w; ++u) {
      const Average a = average_of(above[u], here[u], below[u], sigma[u]);
      smooth_mm_(u, v) = a.depth_mm;
      support_(u, v) = static_cast<std::uint8_t>(row_support_(u, v) * a.support);
    }
  }
}

void SurfelMap::build(const SurfacePatch& patch, const FuseConfig& config, FuseStats& stats) {
  const int w = patch.depth_mm.width();
  const int h = patch.depth_mm.height();
  if (surfels_.width() != w || surfels_.height() != h) {
    surfels_ = Map<Surfel>(w, h);
    along_rows_mm_ = smooth_mm_ = Map<float>(w, h);
    row_support_ = support_ = Map<std::uint8_t>(w, h);
  }
  if (w < 2 || h < 2) {
    return;
  }
  average_rows(patch);
  average_columns(patch);
  const auto cos_min = static_cast<float>(std::cos(config.max_incidence_deg * (M_PI / 180.0)));
  const auto sigma_ref2 = static_cast<float>(config.reference_sigma_mm * config.reference_sigma_mm);
  const auto weight_max = static_cast<float>(config.burst_weight_max);
  std::uint64_t used = 0;
  std::uint64_t steep = 0;
  for (std::size_t i = 0; i < surfels_.size(); ++i) {
    const Vec3f& p = patch.points[i];
    const Vec3f& n = patch.normals[i];
    const float sigma = patch.sigma_mm[i];
    const float np = (n.x() * p.x() + n.y() * p.y()) + n.z() * p.z();
    const float range = std::sqrt((p.x() * p.x() + p.y() * p.y()) + p.z() * p.z());
    const float cosine = -np / range;
    const bool usable = sigma > 0.0F && p.z() > 0.0F && cosine > 0.0F && cosine < 1.01F;  // false for NaN
    const bool facing = usable && cosine >= cos_min;
    const float weight = std::min(weight_max, cosine * (sigma_ref2 / (sigma * sigma)));
    Surfel& s = surfels_[i];
    s.nx = n.x();
    s.ny = n.y();
    s.nz = n.z();
    s.offset_mm = np * (smooth_mm_[i] / p.z());
    s.weight = facing ? weight : 0.0F;
    s.support = support_[i];
    used += facing ? 1U : 0U;
    steep += usable && !facing ? 1U : 0U;
  }
  stats.pixels_used = used;
  stats.pixels_steep = steep;
}

}  // namespace enamel::algo
