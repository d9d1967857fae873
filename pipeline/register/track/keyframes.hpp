// Places seen before, kept so that the model can be found again.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "pipeline/register/feature/features.hpp"
#include "pipeline/register/feature/surface_features.hpp"
#include "pipeline/types/geometry.hpp"
#include "pipeline/types/model_view.hpp"
#include "pipeline/types/patch.hpp"

namespace enamel::pipeline {

struct KeyframeConfig {
  double spacing_mm = 2;          ///< a new one where every old one is farther than this …
  double spacing_deg = 3;         ///< … or turned by more than this
  double work_distance_mm = 48;   ///< spacing is measured at the point this far before the camera
  int view_stride = 2;            ///< camera pixels a pixel of the kept surface
  std::size_t max_tried = 32;     ///< most keyframes compared with one burst: the nearest, then the others by turns
  std::size_t max_described = 4;  ///< keyframes that one burst's search extracts features for; chosen: a burst's time
  std::size_t max_voting = 128;   ///< likewise by surface features; derived: 0.3 ms a keyframe, 40 ms
  FeatureConfig features;
  SurfaceFeatureConfig surface;
};

struct Keyframe {
  Pose T_model_cam = Pose::Identity();
  FeaturePictures pictures;                      ///< until features are asked for
  std::optional<std::vector<Feature>> features;  ///< in its pictures: see KeyframeStore::describe
  ModelView view;                                ///< the patch itself, thinned
  SurfaceGrid grid;                              ///< until it is described
  std::vector<SurfaceFeature> surface;           ///< in its grid: see describe_surface
  bool surface_described = false;
};

class KeyframeStore {
 public:
  KeyframeStore(const calib::LensValues& lens, const KeyframeConfig& config) : lens_(lens), config_(config) {}

  [[nodiscard]] bool wants(const Pose& T_model_cam) const;
  /// view: of the patch from there, every view_stride-th pixel.
  void add(const SurfacePatch& patch, const Pose& T_model_cam, ModelView view);
  /// Extracts the surface features of one keyframe that waits for it, the oldest: half a burst's time, for a burst
  /// that adds no keyframe itself.
  void describe_next_surface();
  /// Of all that are asked for.
  void describe_surface(const std::vector<std::size_t>& asked);
  /// Extracts the features of those keyframes of `asked` that have none yet, the first `most` of them: SIFT costs a
  /// third of a burst's time a keyframe, and most scans never ask for it.
  void describe(const std::vector<std::size_t>& asked, std::size_t most);
  /// Takes over another store's keyframes: those that are wanted here, in their order.
  void absorb(KeyframeStore&& other, const Pose& T_model_other);
  [[nodiscard]] const std::vector<Keyframe>& all() const noexcept { return frames_; }
  /// Indices to try for a burst last known near T: at most `most`, first the nearest, then as many by turns so that
  /// every keyframe is reached within a few bursts. `turn` counts the attempts.
  [[nodiscard]] std::vector<std::size_t> candidates(const Pose& T_model_cam, std::uint64_t turn,
                                                    std::size_t most) const;
  [[nodiscard]] const KeyframeConfig& config() const noexcept { return config_; }

 private:
  void describe_surface(Keyframe& frame) const;

  calib::LensValues lens_;
  KeyframeConfig config_;
  std::vector<Keyframe> frames_;
};

}  // namespace enamel::pipeline
