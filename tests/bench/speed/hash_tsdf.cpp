#include "tests/bench/speed/peers.hpp"

#ifdef ENAMEL_OPENCV_RGBD
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/rgbd/volume.hpp>
#endif

namespace enamel::bench {

#ifdef ENAMEL_OPENCV_RGBD

std::optional<PeerCost> hash_tsdf(const calib::LensValues& lens, const std::vector<PlacedPatch>& patches,
                                  double voxel_mm, double truncation_mm, int repeats) {
  // Its lengths have no unit of their own: mm here. It knows no distortion, which costs it nothing.
  const cv::kinfu::Intr eye(static_cast<float>(lens.fx), static_cast<float>(lens.fy), static_cast<float>(lens.cx),
                            static_cast<float>(lens.cy));
  std::vector<cv::Mat> depths;
  std::vector<cv::Matx44f> poses;
  for (const PlacedPatch& placed : patches) {
    const Map<float>& from = placed.patch.depth_mm;
    cv::Mat& depth = depths.emplace_back(from.height(), from.width(), CV_32F);
    for (std::size_t i = 0; i < from.size(); ++i) {
      depth.at<float>(static_cast<int>(i)) = std::isfinite(from[i]) ? from[i] : 0.0F;
    }
    cv::Matx44f& pose = poses.emplace_back();
    for (int r = 0; r < 4; ++r) {
      for (int c = 0; c < 4; ++c) pose(r, c) = static_cast<float>(placed.T_model_cam.matrix()(r, c));
    }
  }
  return least_of(repeats, patches.size(), [&] {
    const auto volume =
        cv::kinfu::makeVolume(cv::kinfu::VolumeType::HASHTSDF, static_cast<float>(voxel_mm), cv::Matx44f::eye(), 0.25F,
                              static_cast<float>(truncation_mm), 255, 1000.0F, cv::Vec3i(16, 16, 16));
    for (std::size_t i = 0; i < patches.size(); ++i) {
      volume->integrate(depths[i], 1.0F, poses[i], eye, static_cast<int>(i));
    }
  });
}

#else

std::optional<PeerCost> hash_tsdf(const calib::LensValues&, const std::vector<PlacedPatch>&, double, double, int) {
  return std::nullopt;
}

#endif

}  // namespace enamel::bench
