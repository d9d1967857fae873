#include "pipeline/model/fuse/surfel_map.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::pipeline {
namespace {

// A second difference of three equal sigmas has std sqrt(6) sigma; 3.5 of those is noise, more is an edge.
constexpr float kBendLimit = 8.5F;
constexpr double kFinest = 0.7;  ///< surfels are at most this much of a voxel apart

struct Average {
  float depth_mm;
  float support;
};

// Mean of three collinear depths, or the middle one where they bend or one is missing (comparisons with NaN are false).
inline Average average_of(float before, float here, float after, float sigma) noexcept {
  const bool flat = std::fabs((before + after) - 2.0F * here) < kBendLimit * sigma;
  const float mean = ((before + after) + here) * (1.0F / 3.0F);
  return {flat ? mean : here, flat ? 3.0F : 1.0F};
}

}  // namespace

void SurfelMap::average_rows(const SurfacePatch& patch) {
  const int w = patch.depth_mm.width();
  for (int v = 0; v < patch.depth_mm.height(); ++v) {
    const float* z = &patch.depth_mm(0, v);
    const float* sigma = &patch.sigma_mm(0, v);
    float* out = &along_rows_mm_(0, v);
    float* support = &row_support_(0, v);
    out[0] = z[0];
    support[0] = 1.0F;
    out[w - 1] = z[w - 1];
    support[w - 1] = 1.0F;
    for (int u = 1; u < w - 1; ++u) {
      const Average a = average_of(z[u - 1], z[u], z[u + 1], sigma[u]);
      out[u] = a.depth_mm;
      support[u] = a.support;
    }
  }
}

void SurfelMap::average_columns(const SurfacePatch& patch, int v) {
  const int w = patch.depth_mm.width();
  const float* here = &along_rows_mm_(0, v);
  const float* from = &row_support_(0, v);
  float* out = smooth_mm_.data();
  float* support = support_.data();
  if (v == 0 || v + 1 == patch.depth_mm.height()) {
    std::copy(here, here + w, out);
    std::copy(from, from + w, support);
    return;
  }
  const float* above = &along_rows_mm_(0, v - 1);
  const float* below = &along_rows_mm_(0, v + 1);
  const float* sigma = &patch.sigma_mm(0, v);
  for (int u = 0; u < w; ++u) {
    const Average a = average_of(above[u], here[u], below[u], sigma[u]);
    out[u] = a.depth_mm;
    support[u] = from[u] * a.support;
  }
}

SurfelMap::SurfelMap(const calib::Rig& rig, const FuseConfig& config) {
  const calib::LensValues& camera = rig.camera;
  const double depth = calib::middle_depth_mm(rig);
  const double pixels_per_voxel = config.voxel_mm * camera.fx / depth;
  stride_ = pixels_per_voxel * kFinest >= 2.0 ? 2 : 1;
  const int w = std::max(0, (camera.width + stride_ - 1) / stride_);
  const int h = std::max(0, (camera.height + stride_ - 1) / stride_);
  surfels_ = Map<Surfel>(w, h);
  along_rows_mm_ = row_support_ = Map<float>(std::max(0, camera.width), std::max(0, camera.height));
  smooth_mm_.resize(static_cast<std::size_t>(std::max(0, camera.width)));
  support_ = smooth_mm_;
  line_.dot.resize(static_cast<std::size_t>(w));
  line_.z = line_.sigma = line_.per_depth = line_.weight = line_.dot;
  cos_to_axis_ = Map<float>(w, h);
  for (int j = 0; j < h; ++j) {
    for (int i = 0; i < w; ++i) {
      // The lens bends rays by less than 1e-3 rad: nothing for a weight and a limit of incidence.
      const double x = (i * stride_ - camera.cx) / camera.fx;
      const double y = (j * stride_ - camera.cy) / camera.fy;
      cos_to_axis_(i, j) = static_cast<float>(1.0 / std::sqrt(1.0 + x * x + y * y));
    }
  }
}

void SurfelMap::gather_row(const SurfacePatch& patch, int v) {
  const Vec3f* p = &patch.points(0, v);
  const Vec3f* n = &patch.normals(0, v);
  const float* sigma = &patch.sigma_mm(0, v);
  const auto step = static_cast<std::size_t>(stride_);
  for (std::size_t i = 0; i < line_.dot.size(); ++i) {
    const Vec3f& q = p[i * step];
    const Vec3f& m = n[i * step];
    line_.dot[i] = (m.x() * q.x() + m.y() * q.y()) + m.z() * q.z();
    line_.z[i] = q.z();
    line_.sigma[i] = sigma[i * step];
  }
}

void SurfelMap::weigh_row(const FuseConfig& config, int j, FuseStats& stats) {
  const auto cos_min = static_cast<float>(std::cos(config.max_incidence_deg * (M_PI / 180.0)));
  const auto sigma_ref2 = static_cast<float>(config.reference_sigma_mm * config.reference_sigma_mm);
  const auto weight_max = static_cast<float>(config.burst_weight_max);
  const float* sigma = line_.sigma.data();
  const float* to_axis = &cos_to_axis_(0, j);
  const float* dot = line_.dot.data();
  const float* z = line_.z.data();
  float* per_depth = line_.per_depth.data();
  float* weight = line_.weight.data();
  const int w = surfels_.width();
  int used = 0;
  int steep = 0;
  for (int i = 0; i < w; ++i) {
    per_depth[i] = dot[i] / z[i];
    const float cosine = -per_depth[i] * to_axis[i];
    const float full = std::min(weight_max, cosine * (sigma_ref2 / (sigma[i] * sigma[i])));
    const bool usable = (sigma[i] > 0.0F) & (z[i] > 0.0F) & (cosine > 0.0F) & (cosine < 1.01F);  // false for NaN
    const bool facing = usable & (cosine >= cos_min);
    weight[i] = facing ? full : 0.0F;
    used += facing ? 1 : 0;
    steep += (usable & !facing) ? 1 : 0;
  }
  stats.surfels_used += static_cast<std::uint64_t>(used);
  stats.surfels_steep += static_cast<std::uint64_t>(steep);
}

void SurfelMap::scatter_row(const SurfacePatch& patch, int v) {
  const Vec3f* n = &patch.normals(0, v);
  Surfel* out = &surfels_(0, v / stride_);
  const auto step = static_cast<std::size_t>(stride_);
  for (std::size_t i = 0; i < line_.dot.size(); ++i) {
    const Vec3f& m = n[i * step];
    out[i].nx = m.x();
    out[i].ny = m.y();
    out[i].nz = m.z();
    out[i].offset_mm = line_.per_depth[i] * smooth_mm_[i * step];
    out[i].weight = line_.weight[i];
    out[i].support = static_cast<std::uint32_t>(static_cast<std::int32_t>(support_[i * step]));
  }
}

void SurfelMap::build(const SurfacePatch& patch, const FuseConfig& config, FuseStats& stats) {
  average_rows(patch);
  stats.surfels_used = stats.surfels_steep = 0;
  for (int v = 0; v < patch.depth_mm.height(); v += stride_) {
    average_columns(patch, v);
    gather_row(patch, v);
    weigh_row(config, v / stride_, stats);
    scatter_row(patch, v);
  }
}

}  // namespace enamel::pipeline
