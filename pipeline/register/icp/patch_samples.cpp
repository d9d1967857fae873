#include "pipeline/register/icp/patch_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "pipeline/register/icp/pitch.hpp"

namespace enamel::pipeline {
namespace {

/// NaN compares false, so a missing neighbour fails here.
bool far_from_edges(const Map<float>& depth, int u, int v, int reach, float jump) {
  const float z = depth(u, v);
  return std::abs(depth(u - reach, v) - z) < jump && std::abs(depth(u + reach, v) - z) < jump &&
         std::abs(depth(u, v - reach) - z) < jump && std::abs(depth(u, v + reach) - z) < jump;
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

constexpr double kLeastSoftWeight = 0.01;  // layout: a hundredth of them

struct Sample {
  Vec3f p = Vec3f::Zero(), n = Vec3f::Zero();
  float sigma = 0, weight = 0;
  bool soft = false;
};

class SampleRule {
 public:
  SampleRule(const SurfacePatch& patch, const SampleConfig& config)
      : patch_(patch),
        reach_(config.edge_px),
        jump_(static_cast<float>(config.edge_pitches * reach_ * mean_pitch_mm(patch.points))),
        min_cos_(static_cast<float>(std::cos(config.max_incidence_deg * std::numbers::pi / 180))),
        floor2_(static_cast<float>(config.sigma_floor_mm * config.sigma_floor_mm)),
        soft_below_(config.soft_below) {}

  [[nodiscard]] bool take(int u, int v, Sample& out) const {
    if (!far_from_edges(patch_.depth_mm, u, v, reach_, jump_)) return false;
    out.p = patch_.points(u, v);
    out.n = patch_.normals(u, v);
    out.sigma = patch_.sigma_mm(u, v);
    const float cosine = -out.n.dot(out.p) / out.p.norm();
    out.weight = cosine / (out.sigma * out.sigma + floor2_);
    out.soft = is_soft(shade_at(patch_.shade, u, v), soft_below_);
    return cosine > min_cos_ && std::isfinite(out.weight) && out.sigma >= 0;
  }

 private:
  const SurfacePatch& patch_;
  int reach_;
  float jump_, min_cos_, floor2_;
  std::uint8_t soft_below_;
};

/// Fills one set from the rows of a patch. The set's memory is used again.
class SetWriter {
 public:
  SetWriter(SampleSet& out, const SurfacePatch& patch, int stride, const SampleConfig& config)
      : out_(&out),
        stride_(stride),
        offset_(std::max(stride / 2, config.edge_px)),
        soft_step_(static_cast<std::size_t>(std::lround(1 / std::clamp(config.soft_weight, kLeastSoftWeight, 1.0)))) {
    out.offered = 0;
    const auto across = static_cast<std::size_t>(patch.depth_mm.width() / stride + 1);
    const auto down = static_cast<std::size_t>(patch.depth_mm.height() / stride + 1);
    for (auto* field : fields()) field->resize(across * down);
  }
  [[nodiscard]] int stride() const noexcept { return stride_; }
  [[nodiscard]] int offset() const noexcept { return offset_; }
  /// Whether each of this set's samples is one of the other's.
  [[nodiscard]] bool within(const SetWriter& finer) const {
    return stride_ % finer.stride_ == 0 && offset_ >= finer.offset_ && (offset_ - finer.offset_) % finer.stride_ == 0;
  }
  void begin_row(int v) {
    const bool mine = v >= offset_ && (v - offset_) % stride_ == 0;
    next_u_ = mine ? offset_ : std::numeric_limits<int>::max();
  }
  /// Pixels of a row in their order.
  [[nodiscard]] bool wants(int u) {
    if (u != next_u_) return false;
    next_u_ += stride_;
    return true;
  }
  void add(const Sample& s) {
    ++out_->offered;
    if (s.soft && soft_seen_++ % soft_step_ != 0) return;
    out_->x[n_] = s.p.x(), out_->y[n_] = s.p.y(), out_->z[n_] = s.p.z();
    out_->nx[n_] = s.n.x(), out_->ny[n_] = s.n.y(), out_->nz[n_] = s.n.z();
    out_->weights[n_++] = s.weight;
    sigmas_.add(s.sigma);
    sum_ += s.p.cast<double>();
  }
  void end() {
    for (auto* field : fields()) field->resize(n_);
    out_->centroid = n_ > 0 ? Vec3d(sum_ / static_cast<double>(n_)) : Vec3d(Vec3d::Zero());
    out_->median_sigma_mm = sigmas_.median_mm();
  }

 private:
  [[nodiscard]] std::array<std::vector<float>*, 7> fields() const {
    return {&out_->x, &out_->y, &out_->z, &out_->nx, &out_->ny, &out_->nz, &out_->weights};
  }

  SampleSet* out_;
  int stride_, offset_, next_u_ = 0;
  std::size_t n_ = 0, soft_step_, soft_seen_ = 0;
  SigmaHistogram sigmas_;
  Vec3d sum_ = Vec3d::Zero();
};

/// The first writer's samples, of which those of the others are some.
void walk(const SurfacePatch& patch, const SampleRule& rule, int reach, std::span<SetWriter> writers) {
  SetWriter& finest = writers.front();
  Sample sample;
  for (int v = finest.offset(); v < patch.depth_mm.height() - reach; v += finest.stride()) {
    for (SetWriter& writer : writers) writer.begin_row(v);
    for (int u = finest.offset(); u < patch.depth_mm.width() - reach; u += finest.stride()) {
      const bool good = rule.take(u, v, sample);
      for (SetWriter& writer : writers) {
        if (writer.wants(u) && good) writer.add(sample);
      }
    }
  }
  for (SetWriter& writer : writers) writer.end();
}

}  // namespace

void sample_levels(const SurfacePatch& patch, const std::array<int, 3>& strides, const SampleConfig& config,
                   std::array<SampleSet, 3>& out) {
  const SampleRule rule(patch, config);
  const auto writer = [&](std::size_t l) { return SetWriter(out[l], patch, strides[l], config); };
  std::array writers{writer(2), writer(1), writer(0)};  // finest first
  if (writers[1].within(writers[0]) && writers[2].within(writers[0])) {
    walk(patch, rule, config.edge_px, writers);
    return;
  }
  for (SetWriter& one : writers) walk(patch, rule, config.edge_px, {&one, 1});
}

SampleSet sample_patch(const SurfacePatch& patch, int stride, const SampleConfig& config) {
  SampleSet out;
  SetWriter writer(out, patch, stride, config);
  walk(patch, SampleRule(patch, config), config.edge_px, {&writer, 1});
  return out;
}

}  // namespace enamel::pipeline
