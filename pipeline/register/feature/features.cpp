#include "pipeline/register/feature/features.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <optional>
#include <tuple>

namespace enamel::pipeline {
namespace {

/// Of good surface at a camera pixel; between pixels of the mean of the four around. NaN where there is none.
Vec3f surface_at(const SurfacePatch& patch, int u, int v, bool between, const FeatureConfig& config) {
  Vec3f sum = Vec3f::Zero();
  const int last = between ? 1 : 0;
  for (int y = v; y <= v + last; ++y) {
    for (int x = u; x <= u + last; ++x) {
      const bool good = patch.depth_mm.contains(x, y) && std::isfinite(patch.depth_mm(x, y)) &&
                        patch.sigma_mm(x, y) <= static_cast<float>(config.max_sigma_mm);
      if (!good) return Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
      sum += patch.points(x, y);
    }
  }
  return between ? Vec3f(0.25F * sum) : sum;
}

Map<Vec3f> points_of(const SurfacePatch& patch, const FeatureImages& images, const FeatureConfig& config) {
  Map<Vec3f> out(images.texture.width(), images.texture.height(), Vec3f::Zero());
  const int middle = (images.step - 1) / 2;
  for (int j = 0; j < out.height(); ++j) {
    for (int i = 0; i < out.width(); ++i) {
      out(i, j) = surface_at(patch, i * images.step + middle, j * images.step + middle, images.step % 2 == 0, config);
    }
  }
  return out;
}

/// Bilinear point at a picture's place, if the four pixels around it are one good surface.
std::optional<Vec3f> lift(const Map<Vec3f>& points, const cv::Point2f& at, const FeatureConfig& config) {
  const int u = static_cast<int>(std::floor(at.x));
  const int v = static_cast<int>(std::floor(at.y));
  if (!points.contains(u, v) || !points.contains(u + 1, v + 1)) return std::nullopt;
  const std::array<float, 4> depth{points(u, v).z(), points(u + 1, v).z(), points(u, v + 1).z(),
                                   points(u + 1, v + 1).z()};
  const auto [low, high] = std::minmax_element(depth.begin(), depth.end());
  const bool known = std::ranges::none_of(depth, [](float z) { return std::isnan(z); });
  if (!known || *high - *low > static_cast<float>(config.max_spread_mm)) return std::nullopt;
  const float a = at.x - static_cast<float>(u);
  const float b = at.y - static_cast<float>(v);
  const Vec3f top = (1 - a) * points(u, v) + a * points(u + 1, v);
  const Vec3f bottom = (1 - a) * points(u, v + 1) + a * points(u + 1, v + 1);
  return Vec3f((1 - b) * top + b * bottom);
}

/// Strongest first; the rest of the key makes the order total.
auto strength_key(const cv::KeyPoint& k) { return std::make_tuple(-k.response, k.pt.y, k.pt.x, k.size, k.angle); }

void extract_from(const Map<std::uint8_t>& picture, FeatureKind kind, const Map<Vec3f>& points,
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
    const auto point = lift(points, keys[static_cast<std::size_t>(row)].pt, config);
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

FeaturePictures make_feature_pictures(const SurfacePatch& patch, double px_per_mm, const FeatureConfig& config) {
  FeaturePictures out;
  try {
    out.images = make_feature_images(patch, px_per_mm, config.images);
  } catch (const cv::Exception&) {
    return {};
  }
  out.points = points_of(patch, out.images, config);
  return out;
}

std::vector<Feature> extract_features(const FeaturePictures& pictures, const FeatureConfig& config) {
  std::vector<Feature> out;
  if (pictures.points.empty()) return out;
  try {
    extract_from(pictures.images.texture, FeatureKind::kTexture, pictures.points, config, out);
    extract_from(pictures.images.relief, FeatureKind::kRelief, pictures.points, config, out);
  } catch (const cv::Exception&) {
    out.clear();
  }
  return out;
}

std::vector<Feature> extract_features(const SurfacePatch& patch, double px_per_mm, const FeatureConfig& config) {
  return extract_features(make_feature_pictures(patch, px_per_mm, config), config);
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
