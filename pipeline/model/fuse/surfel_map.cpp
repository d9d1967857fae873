#include "pipeline/model/fuse/surfel_map.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/model/fuse/surfel_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr double kFinest = 0.7;  ///< surfels are at most this much of a voxel apart

}  // namespace

void SurfelMap::average_rows(const SurfacePatch& patch) {
  const int w = patch.depth_mm.width(), last = surfels_.width() - 1;
  // The picture's first and last pixel have one neighbour only.
  const int end = last * stride_ + 1 < w ? last + 1 : last;
  for (int v = 0; v < patch.depth_mm.height(); ++v) {
    const float* z = &patch.depth_mm(0, v);
    float* mean = &along_rows_mm_(0, v);
    float* support = &row_support_(0, v);
    average_along_row({z, &patch.sigma_mm(0, v), stride_, 1, std::max(0, end - 1), mean, support});
    mean[0] = z[0];
    support[0] = 1.0F;
    if (end > last) continue;
    mean[last] = z[w - 1];
    support[last] = 1.0F;
  }
}

void SurfelMap::average_columns(const SurfacePatch& patch, int v) {
  const int w = surfels_.width();
  const float* here = &along_rows_mm_(0, v);
  const float* support_here = &row_support_(0, v);
  if (v == 0 || v + 1 == patch.depth_mm.height()) {
    std::copy(here, here + w, smooth_mm_.data());
    std::copy(support_here, support_here + w, support_.data());
    return;
  }
  average_across_rows({&along_rows_mm_(0, v - 1), here, &along_rows_mm_(0, v + 1), support_here, &patch.sigma_mm(0, v),
                       stride_, w, smooth_mm_.data(), support_.data()});
}

SurfelMap::SurfelMap(const calib::Rig& rig, const FuseConfig& config) {
  const calib::LensValues& camera = rig.camera;
  const double depth = calib::middle_depth_mm(rig);
  const double pixels_per_voxel = config.voxel_mm * camera.fx / depth;
  stride_ = pixels_per_voxel * kFinest >= 2.0 ? 2 : 1;
  const int w = std::max(0, (camera.width + stride_ - 1) / stride_);
  const int h = std::max(0, (camera.height + stride_ - 1) / stride_);
  surfels_ = Map<Surfel>(w, h);
  along_rows_mm_ = row_support_ = Map<float>(w, std::max(0, camera.height));
  smooth_mm_.resize(static_cast<std::size_t>(w));
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
  const SurfelCounts counts =
      weigh_surfels(line_.dot.data(), line_.z.data(), line_.sigma.data(), &cos_to_axis_(0, j),
                    {cos_min, sigma_ref2, weight_max}, surfels_.width(), line_.per_depth.data(), line_.weight.data());
  stats.surfels_used += static_cast<std::uint64_t>(counts.used);
  stats.surfels_steep += static_cast<std::uint64_t>(counts.steep);
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
    out[i].offset_mm = line_.per_depth[i] * smooth_mm_[i];
    out[i].weight = line_.weight[i];
    out[i].support = static_cast<std::uint32_t>(static_cast<std::int32_t>(support_[i]));
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
