#include "pipeline/register/feature/features.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <optional>
#include <tuple>

namespace enamel::pipeline {
namespace {

/// Bilinear point at a camera pixel, if its four neighbours are good surface.
std::optional<Vec3f> lift(const SurfacePatch& patch, double u, double v, const FeatureConfig& config) {
  const int u0 = static_cast<int>(std::floor(u));
  const int v0 = static_cast<int>(std::floor(v));
  if (!patch.depth_mm.contains(u0, v0) || !patch.depth_mm.contains(u0 + 1, v0 + 1)) return std::nullopt;
  float low = 1e9F;
  float high = -1e9F;
  for (int k = 0; k < 4; ++k) {
    const std::size_t i = patch.depth_mm.index(u0 + k % 2, v0 + k / 2);
    const float z = patch.depth_mm[i];
    if (!std::isfinite(z) || !(patch.sigma_mm[i] <= static_cast<float>(config.max_sigma_mm))) return std::nullopt;
    low = std::min(low, z);
    high = std::max(high, z);
  }
  if (high - low > static_cast<float>(config.max_spread_mm)) return std::nullopt;
  const auto a = static_cast<float>(u - u0);
  const auto b = static_cast<float>(v - v0);
  const Vec3f top = (1 - a) * patch.points(u0, v0) + a * patch.points(u0 + 1, v0);
  const Vec3f bottom = (1 - a) * patch.points(u0, v0 + 1) + a * patch.points(u0 + 1, v0 + 1);
  return Vec3f((1 - b) * top + b * bottom);
}

/// Strongest first; the rest of the key makes the order total.
auto strength_key(const cv::KeyPoint& k) { return std::make_tuple(-k.response, k.pt.y, k.pt.x, k.size, k.angle); }

void extract_from(const Map<std::uint8_t>& picture, int step, FeatureKind kind, const SurfacePatch& patch,
                  const FeatureConfig& config, std::vector<Feature>& out) {
  // OpenCV takes a mutable pointer but SIFT only reads it; a copy keeps that promise ours to check.
  cv::Mat image(picture.height(), picture.width(), CV_8U);
  std::copy(picture.pixels().begin(), picture.pixels().end(), image.begin<std::uint8_t>());
  const auto sift = cv::SIFT::create(0, 3, config.contrast_threshold, config.edge_threshold, 1.6, CV_8U);
  std::vector<cv::KeyPoint> keys;
  cv::Mat descriptors;
  sift->detectAndCompute(image, cv::noArray(), keys, descriptors);
  std::vector<int> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const auto ka = strength_key(keys[static_cast<std::size_t>(a)]);
    const auto kb = strength_key(keys[static_cast<std::size_t>(b)]);
    return ka != kb ? ka < kb : a < b;
  });
  int kept = 0;
  for (const int row : order) {
    if (kept == config.max_features) break;
    const cv::Point2f at = keys[static_cast<std::size_t>(row)].pt;
    const double half = 0.5 * (step - 1);
    const auto point =
        lift(patch, static_cast<double>(at.x) * step + half, static_cast<double>(at.y) * step + half, config);
    if (!point) continue;
    Feature feature{kind, *point, {}};
    const auto* values = descriptors.ptr<std::uint8_t>(row);
    std::copy(values, values + feature.descriptor.size(), feature.descriptor.begin());
    out.push_back(feature);
    ++kept;
  }
}

int distance2(const Feature& a, const Feature& b) {
  int sum = 0;
  for (std::size_t i = 0; i < a.descriptor.size(); ++i) {
    const int d = static_cast<int>(a.descriptor[i]) - static_cast<int>(b.descriptor[i]);
    sum += d * d;
  }
  return sum;
}

struct Nearest {
  int best = INT32_MAX, second = INT32_MAX;
  std::uint32_t index = 0;
  void offer(int distance, std::uint32_t i) {
    if (distance < best) {
      second = best;
      best = distance;
      index = i;
    } else {
      second = std::min(second, distance);
    }
  }
};

}  // namespace

std::vector<Feature> extract_features(const SurfacePatch& patch, double px_per_mm, const FeatureConfig& config) {
  std::vector<Feature> out;
  try {
    const FeatureImages images = make_feature_images(patch, px_per_mm, config.images);
    extract_from(images.texture, images.step, FeatureKind::kTexture, patch, config, out);
    extract_from(images.relief, images.step, FeatureKind::kRelief, patch, config, out);
  } catch (const cv::Exception&) {
    out.clear();
  }
  return out;
}

std::vector<FeatureMatch> match_features(const std::vector<Feature>& a, const std::vector<Feature>& b, double ratio) {
  std::vector<Nearest> of_a(a.size());
  std::vector<Nearest> of_b(b.size());
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    for (std::uint32_t k = 0; k < b.size(); ++k) {
      if (a[i].kind != b[k].kind) continue;
      const int distance = distance2(a[i], b[k]);
      of_a[i].offer(distance, k);
      of_b[k].offer(distance, i);
    }
  }
  std::vector<FeatureMatch> out;
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    const Nearest& n = of_a[i];
    if (n.best == INT32_MAX || of_b[n.index].index != i) continue;
    if (static_cast<double>(n.best) < ratio * ratio * static_cast<double>(n.second)) out.push_back({i, n.index});
  }
  return out;
}

}  // namespace enamel::pipeline
