#include "host/record/png_image.hpp"

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "protocol/base/file.hpp"

namespace enamel::host {

Result<GreyImage> read_grey_png(const std::string& path) {
  ENAMEL_TRY_ASSIGN(std::string bytes, read_file(path));
  const auto invalid = [&](const std::string& what) { return fail(ErrorCode::kImageInvalid, path + ": " + what); };
  if (bytes.compare(0, 4, "\x89PNG") != 0) return invalid(bytes.empty() ? "the file is empty" : "not a PNG file");
  constexpr std::size_t kDepthAt = 24;  // in IHDR, the first chunk; the decoder widens fewer bits to 8 without a word
  const int bits = bytes.size() > kDepthAt ? static_cast<unsigned char>(bytes[kDepthAt]) : 0;
  cv::Mat image;
  try {
    const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8UC1, bytes.data());
    image = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& e) {
    return invalid(e.err);
  }
  if (image.empty()) return invalid("damaged PNG file");
  if (image.channels() != 1) return invalid(std::to_string(image.channels()) + " channels, grey has one");
  if (bits != 8 && bits != 16) return invalid(std::to_string(bits) + " bit, neither 8 nor 16");
  GreyImage out;
  out.width = image.cols;
  out.height = image.rows;
  out.bits = bits;
  const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
  out.pixels.resize(row * static_cast<std::size_t>(image.rows));
  for (int y = 0; y < image.rows; ++y) {
    std::memcpy(out.pixels.data() + row * static_cast<std::size_t>(y), image.ptr(y), row);
  }
  return out;
}

Result<void> write_grey_png(const std::string& path, int width, int height, int bits,
                            std::span<const std::uint8_t> pixels) {
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * (bits == 8 ? 1U : 2U);
  if (width <= 0 || height <= 0 || pixels.size() != size) {
    return fail(ErrorCode::kImageInvalid, path + ": pixels do not fit the size");
  }
  std::vector<std::uint8_t> encoded;
  try {
    cv::Mat image(height, width, bits == 8 ? CV_8UC1 : CV_16UC1);
    std::memcpy(image.data, pixels.data(), size);
    if (!cv::imencode(".png", image, encoded, {cv::IMWRITE_PNG_COMPRESSION, 1})) {
      return fail(ErrorCode::kInternal, path + ": PNG encoder failed");
    }
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kInternal, path + ": " + e.err);
  }
  return write_file(path, {reinterpret_cast<const char*>(encoded.data()), encoded.size()}, Sync::kLater);
}

}  // namespace enamel::host
