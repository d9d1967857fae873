// The four frames of a burst of an exchange folder, where they have 8 bits.
#pragma once

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>

#include "tests/unit/decode/frame_set.hpp"

namespace enamel::test {

inline std::optional<FrameSet> load_folder_burst(const std::string& folder, int burst) {
  FrameSet set;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(), "/frames/%06d_%zu.png", burst, k);
    const cv::Mat image = cv::imread(folder + name.data(), cv::IMREAD_UNCHANGED);
    if (image.empty() || image.type() != CV_8UC1) return std::nullopt;
    set.width = image.cols;
    set.height = image.rows;
    for (int v = 0; v < image.rows; ++v)
      set.frames[k].insert(set.frames[k].end(), image.ptr<std::uint8_t>(v), image.ptr<std::uint8_t>(v) + image.cols);
  }
  return set;
}

}  // namespace enamel::test
