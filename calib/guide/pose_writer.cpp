#include "calib/guide/pose_writer.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "protocol/base/file.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::calib {
namespace {

namespace fs = std::filesystem;

Result<void> write_grey(const std::string& path, const Map<float>& image, int bits) {
  cv::Mat pixels(image.height(), image.width(), CV_32F, const_cast<float*>(image.pixels().data()));
  std::vector<unsigned char> bytes;
  try {
    cv::Mat grey;
    pixels.convertTo(grey, bits > 8 ? CV_16U : CV_8U);  // rounds to nearest, saturates
    cv::imencode(".png", grey, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception& e) {
    return fail(ErrorCode::kFileWrite, path + ": " + e.what());
  }
  return write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, Sync::kLater);
}

Result<void> write_levels(const std::string& folder, char letter, const std::vector<FringeLevel>& levels, int bits) {
  for (const FringeLevel& level : levels) {
    for (std::size_t k = 0; k < level.frames.size(); ++k)
      ENAMEL_TRY(write_grey(fmt::format("{}/{}_{}_{}.png", folder, letter, level.cycles, k), level.frames[k], bits));
  }
  return {};
}

}  // namespace

Result<PoseWriter> PoseWriter::begin(const std::string& folder) {
  std::error_code ec;
  if (fs::exists(folder, ec) && !fs::is_empty(folder, ec))
    return fail(ErrorCode::kUsage, folder + " is there already; choose another folder");
  PoseWriter writer(folder);
  fs::remove_all(writer.partial_, ec);
  ENAMEL_TRY(make_folder(writer.partial_ + "/poses"));
  return writer;
}

PoseWriter::PoseWriter(PoseWriter&& other) noexcept
    : folder_(std::move(other.folder_)),
      partial_(std::move(other.partial_)),
      written_(other.written_),
      is_done_(std::exchange(other.is_done_, true)) {}

PoseWriter::~PoseWriter() {
  std::error_code ec;
  if (!is_done_) fs::remove_all(partial_, ec);
}

Result<void> PoseWriter::write(const PoseFrames& frames, int bits) {
  const std::string pose = fmt::format("{}/poses/{:02}", partial_, written_);
  ENAMEL_TRY(make_folder(pose));
  ENAMEL_TRY(write_grey(pose + "/white.png", frames.white, bits));
  ENAMEL_TRY(write_grey(pose + "/black.png", frames.black, bits));
  ENAMEL_TRY(write_levels(pose, 'v', frames.along_u, bits));
  ENAMEL_TRY(write_levels(pose, 'h', frames.along_v, bits));
  ++written_;
  return {};
}

Result<void> PoseWriter::commit(const Rig& nominal, const std::string& target_text, int averaged_frames,
                                std::optional<double> temp_c) {
  auto json = nlohmann::ordered_json::parse(nominal.text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return fail(ErrorCode::kRigInvalid, "the probe's rig is no JSON object");
  json["nominal"] = true;
  if (json.contains("noise") && averaged_frames > 1) json["noise"]["averaged_frames"] = averaged_frames;
  if (temp_c) json["temp_c"] = *temp_c;
  ENAMEL_TRY(write_file(partial_ + "/rig.json", json_text(json, 1) + "\n"));
  ENAMEL_TRY(write_file(partial_ + "/target.json", target_text));
  std::error_code ec;
  fs::remove(folder_, ec);
  fs::rename(partial_, folder_, ec);
  if (ec) return fail(ErrorCode::kFileWrite, folder_ + ": " + ec.message());
  is_done_ = true;
  return {};
}

}  // namespace enamel::calib
