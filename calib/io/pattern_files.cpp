#include "calib/io/pattern_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <span>
#include <vector>

#include "calib/model/pattern.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::calib {
namespace {

using Json = nlohmann::ordered_json;

cv::Mat picture(const std::vector<std::uint8_t>& line, bool axis_v, const LensValues& projector) {
  const cv::Mat row(1, static_cast<int>(line.size()), CV_8UC1, const_cast<std::uint8_t*>(line.data()));
  return axis_v ? cv::repeat(row.t(), 1, projector.width) : cv::repeat(row, projector.height, 1);
}

Result<std::string> png_of(const cv::Mat& image) {
  std::vector<std::uint8_t> png;
  try {
    if (!cv::imencode(".png", image, png)) return fail(ErrorCode::kInternal, "a pattern cannot be encoded");
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kInternal, std::string("a pattern cannot be encoded: ") + e.what());
  }
  return std::string(png.begin(), png.end());
}

Result<void> check(const PatternValues& p) {
  if (!is_burst_set(p)) {
    return fail(ErrorCode::kPatternSet,
                "mode multi is a calibration set: give the probe's own rig, and the solved one with --calibration");
  }
  if (p.mean - p.amplitude >= 0 && p.mean + p.amplitude <= 255) return {};
  return fail(ErrorCode::kPatternSet, fmt::format("patterns from {} to {} do not fit a projector's levels 0 to 255: "
                                                  "lower amplitude, or set mean to 127.5",
                                                  p.mean - p.amplitude, p.mean + p.amplitude));
}

}  // namespace

Result<std::string> write_patterns(const Rig& rig, const std::string& folder) {
  ENAMEL_TRY(check(rig.patterns));
  ENAMEL_TRY(make_folder(folder));
  const PatternTable table = pattern_table(rig);
  Json json{{"mode", std::string(mode_name(rig.patterns))},
            {"period_px", rig.patterns.period_px},
            {"axis", table.axis_v ? "v" : "u"},
            {"width", rig.projector.width},
            {"height", rig.projector.height},
            {"serial", rig.serial},
            {"linearised", rig.response.has_value()},
            {"frames", Json::array()}};
  for (std::size_t k = 0; k < table.frames.size(); ++k) {
    const auto& line = table.frames[k];
    const cv::Mat image = picture(line, table.axis_v, rig.projector);
    ENAMEL_TRY_ASSIGN(const std::string png, png_of(image));
    const std::string file = fmt::format("frame_{}.png", k);
    ENAMEL_TRY(write_file(fmt::format("{}/{}", folder, file), png));
    const auto [low, high] = std::minmax_element(line.begin(), line.end());
    const std::span<const std::uint8_t> pixels(image.ptr(), image.total());
    json["frames"].push_back(
        {{"file", file}, {"lowest", *low}, {"highest", *high}, {"crc32", crc32(std::as_bytes(pixels))}});
  }
  std::string text = json_text(json, 2) + "\n";
  ENAMEL_TRY(write_file(folder + "/patterns.json", text));
  return text;
}

}  // namespace enamel::calib
