// The exact truth of a burst of an exchange folder that holds it.
#pragma once

#include <array>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string>

#include "tests/support/plain_floor.hpp"

namespace enamel::test {

/// From truth/depth_BBBBBB.pfm (camera z, mm) and truth/lit_BBBBBB.png.
inline std::optional<DepthTruth> load_folder_truth(const std::string& folder, int burst) {
  const auto read = [&](const char* pattern) {
    std::array<char, 64> name{};
    std::snprintf(name.data(), name.size(), pattern, burst);
    return cv::imread(folder + name.data(), cv::IMREAD_UNCHANGED);
  };
  const cv::Mat depth = read("/truth/depth_%06d.pfm"), lit = read("/truth/lit_%06d.png");
  if (depth.type() != CV_32FC1 || lit.type() != CV_8UC1 || depth.empty() || depth.size() != lit.size())
    return std::nullopt;
  DepthTruth out{Map<float>(depth.cols, depth.rows), Map<std::uint8_t>(depth.cols, depth.rows), {}};
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      out.depth_mm(u, v) = depth.at<float>(v, u);
      out.lit(u, v) = lit.at<std::uint8_t>(v, u);
    }
  }
  out.edge = depth_edges(out.depth_mm);
  return out;
}

}  // namespace enamel::test
