#include "pipeline/register/track/burst_texture.hpp"

namespace enamel::pipeline {

const std::shared_ptr<const TexturePicture>& BurstTexture::picture() {
  if (!picture_) {
    picture_ = std::make_shared<const TexturePicture>(
        make_texture_picture(patch_, config_.px_per_mm, config_.phase, config_.picture));
  }
  return picture_;
}

const TextureReference& BurstTexture::reference() {
  if (!reference_) reference_ = texture_reference(*picture(), Pose::Identity());
  return *reference_;
}

const TexturePoints& BurstTexture::points() {
  if (!points_) points_ = texture_points(patch_, reference(), config_.term);
  return *points_;
}

}  // namespace enamel::pipeline
