#include "viewer/gl/picture.hpp"

#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "protocol/base/file.hpp"

namespace enamel::view {

Result<void> write_png(const Picture& picture, const std::string& path) {
  const std::size_t expected = 3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
  if (picture.width <= 0 || picture.height <= 0 || picture.rgb.size() != expected) {
    return fail(ErrorCode::kInternal, "picture of " + std::to_string(picture.width) + " x " +
                                          std::to_string(picture.height) + " with " +
                                          std::to_string(picture.rgb.size()) + " bytes");
  }
  std::vector<unsigned char> bgr(picture.rgb.size());
  for (std::size_t i = 0; i < bgr.size(); i += 3) {
    bgr[i] = picture.rgb[i + 2];
    bgr[i + 1] = picture.rgb[i + 1];
    bgr[i + 2] = picture.rgb[i];
  }
  std::vector<unsigned char> png;
  try {
    const cv::Mat image(picture.height, picture.width, CV_8UC3, bgr.data());
    if (!cv::imencode(".png", image, png)) {
      return fail(ErrorCode::kFileWrite, path + ": the picture cannot be encoded as PNG");
    }
  } catch (const cv::Exception& problem) {
    return fail(ErrorCode::kFileWrite, path + ": " + problem.what());
  }
  return write_file(path, std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
}

}  // namespace enamel::view
