#include "pipeline/decode/motion/motion_images.hpp"

namespace enamel::pipeline {

void MotionImage::resize(int width, int height) {
  width_ = (width + 1) / 2;
  height_ = (height + 1) / 2;
  pitch_ = (width_ + 3) / 4;
  data_.resize(4 * static_cast<std::size_t>(pitch_) * static_cast<std::size_t>(height_));
}

void MotionImage::set_row(int y, const float* row) {
  float* out = data_.data() + static_cast<std::ptrdiff_t>(y) * 4 * pitch_;
  for (int place = 0; place < 4; ++place, out += pitch_) {
    const int count = (width_ - place + 3) / 4;
    for (int k = 0; k < count; ++k) out[k] = row[4 * k + place];
  }
}

void MotionImages::resize(int width, int height) {
  const auto columns = static_cast<std::size_t>(width + 1) / 2;
  inverse_depth.resize(width, height);
  light.resize(width, height);
  for (std::vector<float>* v : {&phase, &row, &light_row}) v->resize(columns);
}

}  // namespace enamel::pipeline
