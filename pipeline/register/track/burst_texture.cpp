#include "pipeline/register/track/burst_texture.hpp"

namespace enamel::pipeline {

const std::shared_ptr<const TexturePicture>& BurstTexture::picture() {
  if (!picture_) {
    picture_ = std::make_shared<const TexturePicture>(
        make_texture_picture(patch_, config_.px_per_mm, config_.phase, config_.picture));
  }
  return picture_;
}

const TexturePoints& BurstTexture::points() {
  if (!points_) points_ = std::make_unique<const TexturePoints>(texture_points(patch_, *picture(), config_.term));
  return *points_;
}

}  // namespace enamel::pipeline
