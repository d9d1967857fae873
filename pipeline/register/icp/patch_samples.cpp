#include "pipeline/register/icp/patch_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pipeline/register/icp/pitch.hpp"

namespace enamel::pipeline {
namespace {

/// NaN compares false, so a missing neighbour fails here.
bool far_from_edges(const Map<float>& depth, int u, int v, int reach, float jump) {
  const float z = depth(u, v);
  return std::abs(depth(u - reach, v) - z) < jump && std::abs(depth(u + reach, v) - z) < jump &&
         std::abs(depth(u, v - reach) - z) < jump && std::abs(depth(u, v + reach) - z) < jump;
}

void append(SampleSet& out, const Vec3f& p, const Vec3f& n, float weight) {
  out.x.push_back(p.x());
  out.y.push_back(p.y());
  out.z.push_back(p.z());
  out.nx.push_back(n.x());
  out.ny.push_back(n.y());
  out.nz.push_back(n.z());
  out.weights.push_back(weight);
}

void reserve(SampleSet& out, std::size_t n) {
  for (auto* field : {&out.x, &out.y, &out.z, &out.nx, &out.ny, &out.nz, &out.weights}) field->reserve(n);
}

class SigmaHistogram {
 public:
  void add(float sigma_mm) {
    const auto bin = static_cast<std::size_t>(sigma_mm * 1000.0F);
    ++bins_[std::min(bin, bins_.size() - 1)];
    ++count_;
  }
  [[nodiscard]] double median_mm() const {
    std::size_t seen = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      seen += bins_[i];
      if (2 * seen >= count_) return (static_cast<double>(i) + 0.5) * 1e-3;
    }
    return 0;
  }

 private:
  std::array<std::size_t, 250> bins_{};
  std::size_t count_ = 0;
};

}  // namespace

SampleSet sample_patch(const SurfacePatch& patch, int stride, const SampleConfig& config) {
  SampleSet out;
  const int reach = config.edge_px;
  const auto jump = static_cast<float>(config.edge_pitches * reach * mean_pitch_mm(patch.points));
  const auto min_cos = static_cast<float>(std::cos(config.max_incidence_deg * std::numbers::pi / 180));
  const auto floor2 = static_cast<float>(config.sigma_floor_mm * config.sigma_floor_mm);
  const int offset = std::max(stride / 2, reach);
  reserve(out, patch.depth_mm.size() / static_cast<std::size_t>(stride * stride));
  SigmaHistogram sigmas;
  Vec3d sum = Vec3d::Zero();
  for (int v = offset; v < patch.depth_mm.height() - reach; v += stride) {
    for (int u = offset; u < patch.depth_mm.width() - reach; u += stride) {
      if (!far_from_edges(patch.depth_mm, u, v, reach, jump)) continue;
      const Vec3f& p = patch.points(u, v);
      const Vec3f& n = patch.normals(u, v);
      const float sigma = patch.sigma_mm(u, v);
      const float cosine = -n.dot(p) / p.norm();
      const float weight = cosine / (sigma * sigma + floor2);
      if (!(cosine > min_cos) || !std::isfinite(weight) || !(sigma >= 0)) continue;
      append(out, p, n, weight);
      sigmas.add(sigma);
      sum += p.cast<double>();
    }
  }
  if (out.size() > 0) out.centroid = sum / static_cast<double>(out.size());
  out.median_sigma_mm = sigmas.median_mm();
  return out;
}

}  // namespace enamel::pipeline
