// Points on the surface that can be recognised again, each with a SIFT description and its place in space.
// Lowe 2004 (SIFT, ratio test); two pictures a patch: texture and relief.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/register/feature/feature_images.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

enum class FeatureKind : std::uint8_t { kTexture, kRelief };

struct Feature {
  FeatureKind kind = FeatureKind::kTexture;
  Vec3f point = Vec3f::Zero();  ///< camera frame of its patch, mm
  std::array<std::uint8_t, 128> descriptor{};
};

struct FeatureConfig {
  ImageConfig images;
  int max_features = 350;             ///< of each kind, the strongest
  double contrast_threshold = 0.006;  ///< half a grey level: twice what shot noise leaves in a block mean
  double edge_threshold = 12;
  double max_sigma_mm = 0.1;   ///< features on worse measured surface are dropped
  double max_spread_mm = 0.4;  ///< depth range among the four picture pixels around it: beyond, it lies on an edge
  double ratio = 0.8;          ///< best distance / second best
};

/// What features are sought in, small enough to be kept.
struct FeaturePictures {
  FeatureImages images;
  Map<Vec3f> points;  ///< surface at the middle of each picture pixel, camera frame, mm; NaN where it is not good
};

/// An OpenCV failure gives empty pictures. Pure.
[[nodiscard]] FeaturePictures make_feature_pictures(const SurfacePatch& patch, double px_per_mm,
                                                    const FeatureConfig& config);

/// Deterministic: same patch, same features in the same order, whatever the number of OpenCV threads (its work is split
/// by rows and keypoints only; the order is ours). Thread-safe. An OpenCV failure gives an empty list.
[[nodiscard]] std::vector<Feature> extract_features(const FeaturePictures& pictures, const FeatureConfig& config);
[[nodiscard]] std::vector<Feature> extract_features(const SurfacePatch& patch, double px_per_mm,
                                                    const FeatureConfig& config);

struct FeatureMatch {
  std::uint32_t a = 0;  ///< index in the first list
  std::uint32_t b = 0;  ///< index in the second
};

/// Nearest neighbours of the same kind that choose each other and are clearly nearer than the second. Ordered by a.
[[nodiscard]] std::vector<FeatureMatch> match_features(const std::vector<Feature>& a, const std::vector<Feature>& b,
                                                       double ratio);

}  // namespace enamel::pipeline
