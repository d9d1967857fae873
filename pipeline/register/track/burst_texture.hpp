// A burst's texture, made when it is first asked for: most surfaces hold themselves. Private to register/track.
#pragma once

#include <memory>
#include <optional>

#include "pipeline/register/feature/surface_texture.hpp"
#include "pipeline/register/icp/texture_term.hpp"

namespace enamel::pipeline {

/// Refers to the patch. Not thread-safe.
class BurstTexture {
 public:
  struct Config {
    SurfaceTextureConfig picture;
    TextureConfig term;
    double px_per_mm = 1;
    FringePhase phase;
  };
  BurstTexture(const SurfacePatch& patch, const Config& config) : patch_(patch), config_(config) {}

  [[nodiscard]] const std::shared_ptr<const TexturePicture>& picture();
  [[nodiscard]] const TexturePoints& points();
  /// For bursts to come, in the frame of the burst's own camera.
  [[nodiscard]] const TextureReference& reference();
  /// The picture, if anybody has asked for it.
  [[nodiscard]] const std::shared_ptr<const TexturePicture>& picture_if_made() const noexcept { return picture_; }

 private:
  const SurfacePatch& patch_;
  const Config& config_;
  std::shared_ptr<const TexturePicture> picture_;
  std::optional<TextureReference> reference_;
  std::optional<TexturePoints> points_;
};

}  // namespace enamel::pipeline
