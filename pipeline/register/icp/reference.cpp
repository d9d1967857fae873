#include "pipeline/register/icp/reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pipeline/register/icp/pitch.hpp"
#include "pipeline/register/icp/window_rows.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool close(const Vec3f& a, const Vec3f& b, float jump2) { return (a - b).squaredNorm() < jump2; }

/// A view thinned to every step-th pixel.
struct Thinned {
  const ModelView& view;
  int step, width, height;
  [[nodiscard]] const Vec3f& point(int u, int v) const { return view.points(u * step, v * step); }
  [[nodiscard]] const Vec3f& normal(int u, int v) const { return view.normals(u * step, v * step); }
};

/// Elements of a pixel: the sum of unit normals and, last, their number.
constexpr std::size_t kSum = 4;

/// Of the windows of 2 * radius + 1 pixels each way about every pixel, zeros beyond the border. In scratch.sums.
void window_sums(const Thinned& of, int radius, ReferenceScratch& scratch) {
  const auto width = static_cast<std::size_t>(of.width), height = static_cast<std::size_t>(of.height);
  const auto reach = static_cast<std::size_t>(radius);
  const std::size_t row = kSum * width;
  scratch.line.assign(row + 2 * kSum * reach, 0.0F);
  scratch.rows.resize(row * height);
  scratch.sums.resize(row * height);
  for (int v = 0; v < of.height; ++v) {
    float* known = scratch.line.data() + kSum * reach;
    for (int u = 0; u < of.width; ++u, known += kSum) {
      const Vec3f& n = of.normal(u, v);
      const bool there = std::isfinite(n.x());
      for (Eigen::Index k = 0; k < 3; ++k) known[k] = there ? n[k] : 0.0F;
      known[3] = there ? 1.0F : 0.0F;
    }
    sum_shifted(scratch.line.data(), kSum, 2 * reach + 1, row, &scratch.rows[row * static_cast<std::size_t>(v)]);
  }
  for (std::size_t v = 0; v < height; ++v) {
    const std::size_t first = v > reach ? v - reach : 0, last = std::min(height - 1, v + reach);
    sum_shifted(&scratch.rows[row * first], row, last - first + 1, row, &scratch.sums[row * v]);
  }
}

/// Of each pixel of row v whether the next one along the row lies close by, and the one in the next row.
void note_close(const Thinned& of, int v, float jump2, std::vector<std::uint8_t>& along,
                std::vector<std::uint8_t>& across) {
  const auto step = static_cast<std::size_t>(of.step), last = static_cast<std::size_t>(of.width) - 1;
  const Vec3f* here = &of.point(0, v);
  const Vec3f* below = v + 1 < of.height ? &of.point(0, v + 1) : nullptr;
  for (std::size_t u = 0; u <= last; ++u) {
    const Vec3f& p = here[u * step];
    along[u] = u < last && close(here[(u + 1) * step], p, jump2) ? 1 : 0;
    across[u] = below != nullptr && close(below[u * step], p, jump2) ? 1 : 0;
  }
}

}  // namespace

Reference::Reference(const ModelView& view, const ReferenceConfig& config) {
  ReferenceScratch scratch;
  draw(view, config, scratch);
}

void Reference::draw(const ModelView& view, const ReferenceConfig& config, ReferenceScratch& scratch) {
  T_model_cam_ = view.T_model_cam;
  usable_px_ = 0;
  if (view.empty || view.points.empty() || view.stride < 1) return;
  const double pitch = mean_pitch_mm(view.points);
  if (!(pitch > 0)) return;
  const int step = std::max(1, static_cast<int>(std::lround(config.pitch_mm / pitch)));
  const int radius = std::max(1, static_cast<int>(std::lround(config.normal_radius_mm / (pitch * step))));
  const Thinned of{view, step, (view.points.width() + step - 1) / step, (view.points.height() + step - 1) / step};
  scale_ = 1.0F / static_cast<float>(view.stride * step);
  window_sums(of, radius, scratch);
  if (pixels_.width() != of.width || pixels_.height() != of.height) pixels_ = Map<Pixel>(of.width, of.height);
  std::ranges::fill(pixels_.pixels(), Pixel{Vec3f::Constant(kNan), 0, Vec3f::Constant(kNan), 0});
  const double jump = config.edge_pitches * pitch * step;
  const auto jump2 = static_cast<float>(jump * jump);
  const auto coherence = static_cast<float>(config.min_coherence);
  for (auto* flags : {&scratch.along, &scratch.across, &scratch.across_before})
    flags->resize(static_cast<std::size_t>(of.width));
  note_close(of, 0, jump2, scratch.along, scratch.across);
  for (int v = 1; v + 1 < of.height; ++v) {
    std::swap(scratch.across, scratch.across_before);
    note_close(of, v, jump2, scratch.along, scratch.across);
    for (int u = 1; u + 1 < of.width; ++u) {
      const auto at = static_cast<std::size_t>(u);
      if ((scratch.along[at - 1] & scratch.along[at] & scratch.across_before[at] & scratch.across[at]) == 0) continue;
      const float* of_window = &scratch.sums[kSum * pixels_.index(u, v)];
      const Vec3f sum(of_window[0], of_window[1], of_window[2]);
      const float length = sum.norm();
      if (!std::isfinite(of.normal(u, v).x()) || !(length > coherence * of_window[3])) continue;
      pixels_(u, v).point = of.point(u, v);
      pixels_(u, v).normal = sum / length;
      ++usable_px_;
    }
  }
}

}  // namespace enamel::pipeline
