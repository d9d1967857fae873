// Four frames, for tests; read from an exchange folder where they have 8 bits.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/algo/phase/burst_view.hpp"

namespace enamel::test {

struct FrameSet {
  int width = 0, height = 0;
  std::array<std::vector<std::uint8_t>, 4> frames;
  int bit_depth = 8;

  [[nodiscard]] algo::BurstView view() const {
    algo::BurstView v{width, height, bit_depth, {}};
    for (std::size_t k = 0; k < 4; ++k) v.frames[k] = frames[k];
    return v;
  }
};

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
