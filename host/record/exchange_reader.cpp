#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "host/record/png_image.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/base/file.hpp"
#include "protocol/base/litter.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::host {
namespace {

namespace fs = std::filesystem;

// The few values of the rig that images are checked against; the rig itself is read by those who use it.
struct ExpectedImage {
  int width = 0, height = 0, bits = 0;
};

int int_at(const nlohmann::json& root, const char* section, const char* key) {
  const auto part = root.find(section);
  if (part == root.end() || !part->is_object()) return 0;
  const auto value = part->find(key);
  if (value == part->end() || !value->is_number_integer()) return 0;
  const auto n = value->get<std::int64_t>();
  return n > 0 && n <= 0xFFFF ? static_cast<int>(n) : 0;
}

Result<ExpectedImage> expected_image(const std::string& rig_text, const std::string& path) {
  const auto root = nlohmann::json::parse(rig_text, nullptr, false);
  if (root.is_discarded())
    return fail(ErrorCode::kRigInvalid, path + ": not valid JSON (NaN and infinity are no JSON numbers)");
  if (!root.is_object()) return fail(ErrorCode::kRigInvalid, path + ": not a JSON object");
  return ExpectedImage{int_at(root, "camera", "width"), int_at(root, "camera", "height"),
                       int_at(root, "noise", "bits")};
}

Result<std::vector<std::string>> list_files(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code ec;
  for (fs::recursive_directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    std::error_code kind;
    const fs::path name = it->path().lexically_relative(folder);
    if (it->is_regular_file(kind) && !is_litter(name)) names.push_back(name.generic_string());
  }
  if (ec) return fail(ErrorCode::kFileRead, folder + ": " + ec.message());
  std::sort(names.begin(), names.end());
  return names;
}

std::string size_text(int width, int height, int bits) {
  return std::to_string(width) + " x " + std::to_string(height) + " of " + std::to_string(bits) + " bit";
}

int depth_of(const GreyImage& image, int rig_bits) {
  if (image.bits == 8) return 8;
  return rig_bits > 8 && rig_bits < 16 ? rig_bits : 16;
}

struct PixelSummary {
  std::uint16_t mean_q4 = 0;
  std::uint16_t saturated_permille = 0;
  std::uint32_t max = 0;
};

PixelSummary summarize(const GreyImage& image, int depth) {
  const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const std::uint32_t full = (1U << static_cast<unsigned>(depth)) - 1U;
  std::uint64_t sum = 0, saturated = 0;
  PixelSummary out;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t v =
        image.bits == 8 ? image.pixels[i] : image.pixels[2 * i] | (std::uint32_t{image.pixels[2 * i + 1]} << 8U);
    sum += v;
    saturated += v >= full ? 1U : 0U;
    out.max = std::max(out.max, v);
  }
  out.mean_q4 = static_cast<std::uint16_t>(std::min<std::uint64_t>(sum * 16 / count, 0xFFFF));
  out.saturated_permille = static_cast<std::uint16_t>(saturated * 1000 / count);
  return out;
}

proto::Burst burst_of_row(const ExchangeRow& row, std::size_t n) {
  proto::Burst b;
  b.burst_seq = n;
  b.burst_index = row.burst_id;
  b.t_first_exposure_ns = static_cast<std::uint64_t>(row.t_ns[0]);
  b.t_publish_ns = static_cast<std::uint64_t>(row_end_ns(row));
  const std::int64_t period = row.t_ns[1] - row.t_ns[0];
  b.frame_period_ns = static_cast<std::uint32_t>(std::min<std::int64_t>(period, 0xFFFFFFFF));
  b.illum_us = row.exposure_us;
  b.temp_centi_c = static_cast<std::int16_t>(std::lround(row.temp_c * 100));
  b.meta.resize(proto::kFramesPerBurst);
  for (std::size_t k = 0; k < b.meta.size(); ++k) {
    proto::FrameMeta& m = b.meta[k];
    m.sensor_seq = static_cast<std::uint32_t>(n * proto::kFramesPerBurst + k);
    m.pattern_index = static_cast<std::uint8_t>(k);
    m.exposure_us = row.exposure_us;
    m.t_strobe_ns = static_cast<std::uint64_t>(row.t_ns[k]);
    m.t_sensor_ns = m.t_strobe_ns + std::uint64_t{row.exposure_us} * 1000;
  }
  return b;
}

}  // namespace

Result<ExchangeReader> ExchangeReader::open(const std::string& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) return fail(ErrorCode::kFileNotFound, folder + " is not a folder");
  ExchangeReader reader;
  reader.folder_ = folder;
  const auto part = [&](const char* name) -> Result<std::string> {
    auto text = read_file((fs::path(folder) / name).string());
    if (!text && text.error().code == ErrorCode::kFileNotFound) {
      return fail(ErrorCode::kExchangeInvalid, folder + ": " + name + " is missing");
    }
    return text;
  };
  ENAMEL_TRY_ASSIGN(reader.rig_text_, part(kRigFile));
  ENAMEL_TRY_ASSIGN(const ExpectedImage expected,
                    expected_image(reader.rig_text_, (fs::path(folder) / kRigFile).string()));
  reader.width_ = expected.width;
  reader.height_ = expected.height;
  reader.rig_bits_ = expected.bits;
  ENAMEL_TRY_ASSIGN(reader.table_text_, part(kTableFile));
  const std::string table_path = (fs::path(folder) / kTableFile).string();
  ENAMEL_TRY_ASSIGN(reader.rows_, parse_bursts_csv(reader.table_text_, table_path));
  if (reader.rows_.empty()) return fail(ErrorCode::kEmptyInput, table_path + " has no rows");
  ENAMEL_TRY_ASSIGN(reader.extra_files_, list_files(folder));
  std::vector<std::string> known{kRigFile, kTableFile};
  for (const ExchangeRow& row : reader.rows_) {
    for (int k = 0; k < proto::kFramesPerBurst; ++k) known.push_back(frame_file(row.burst_id, k));
  }
  std::sort(known.begin(), known.end());
  const auto& files = reader.extra_files_;
  for (const ExchangeRow& row : reader.rows_) {
    for (int k = 0; k < proto::kFramesPerBurst; ++k) {
      const std::string name = frame_file(row.burst_id, k);
      if (std::binary_search(files.begin(), files.end(), name)) continue;
      return fail(ErrorCode::kExchangeInvalid, at_line(table_path, row.line) + "frame " + name + " is missing");
    }
  }
  std::erase_if(reader.extra_files_,
                [&](const std::string& name) { return std::binary_search(known.begin(), known.end(), name); });
  ENAMEL_TRY(reader.check_first_frame());
  ENAMEL_TRY(reader.read_axes());
  return reader;
}

// Where there is axes.csv its rows are angles of bursts that are there. Bursts without a row are taken.
Result<void> ExchangeReader::read_axes() {
  axes_.assign(rows_.size(), std::nullopt);
  if (std::ranges::find(extra_files_, kAxesFile) == extra_files_.end()) return {};
  const std::string path = (fs::path(folder_) / kAxesFile).string();
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  ENAMEL_TRY_ASSIGN(auto readings, proto::parse_burst_axes(text, path));
  std::ranges::sort(readings, {}, &proto::AxesReading::burst_index);
  proto::number_stops(readings);
  for (const proto::AxesReading& reading : readings) {
    const auto at = std::ranges::lower_bound(rows_, reading.burst_index, {}, &ExchangeRow::burst_id);
    if (at == rows_.end() || at->burst_id != reading.burst_index)
      return fail(ErrorCode::kExchangeInvalid,
                  path + ": burst " + std::to_string(reading.burst_index) +
                      " is not in bursts.csv; it belongs to another scan, or the burst was removed");
    axes_[static_cast<std::size_t>(at - rows_.begin())] = reading;
  }
  return {};
}

// All frames of a folder have the size and depth of the first, and that has the size of the rig's camera.
Result<void> ExchangeReader::check_first_frame() {
  const std::string path = (fs::path(folder_) / frame_file(rows_.front().burst_id, 0)).string();
  ENAMEL_TRY_ASSIGN(const GreyImage first, read_grey_png(path));
  if (width_ != 0 && height_ != 0 && (first.width != width_ || first.height != height_)) {
    return fail(ErrorCode::kImageInvalid, path + ": " + size_text(first.width, first.height, first.bits) +
                                              ", but rig.json says " + std::to_string(width_) + " x " +
                                              std::to_string(height_));
  }
  if (first.width > 0xFFFF || first.height > 0xFFFF) return fail(ErrorCode::kImageInvalid, path + ": too large");
  width_ = first.width;
  height_ = first.height;
  file_bits_ = first.bits;
  return {};
}

Result<proto::Burst> ExchangeReader::burst(std::size_t n) const {
  if (n >= rows_.size()) return fail(ErrorCode::kBurstNotFound, folder_ + ": no row " + std::to_string(n));
  const ExchangeRow& row = rows_[n];
  proto::Burst b = burst_of_row(row, n);
  b.width = static_cast<std::uint16_t>(width_);
  b.height = static_cast<std::uint16_t>(height_);
  for (int k = 0; k < proto::kFramesPerBurst; ++k) {
    const std::string path = (fs::path(folder_) / frame_file(row.burst_id, k)).string();
    ENAMEL_TRY_ASSIGN(const GreyImage image, read_grey_png(path));
    if (image.width != width_ || image.height != height_ || image.bits != file_bits_) {
      return fail(ErrorCode::kImageInvalid, path + ": " + size_text(image.width, image.height, image.bits) +
                                                ", the other frames are " + size_text(width_, height_, file_bits_));
    }
    const int depth = depth_of(image, rig_bits_);
    const PixelSummary summary = summarize(image, depth);
    if (summary.max >> static_cast<unsigned>(depth) != 0) {
      return fail(ErrorCode::kImageInvalid,
                  path + ": a pixel is beyond the " + std::to_string(depth) + " bits that rig.json states");
    }
    proto::FrameMeta& m = b.meta[static_cast<std::size_t>(k)];
    m.mean_q4 = summary.mean_q4;
    m.saturated_permille = summary.saturated_permille;
    m.offset = static_cast<std::uint32_t>(b.payload.size());
    m.length = static_cast<std::uint32_t>(image.pixels.size());
    b.bit_depth = static_cast<std::uint8_t>(depth);
    b.payload.insert(b.payload.end(), image.pixels.begin(), image.pixels.end());
  }
  b.codec = b.bit_depth == 8 ? proto::Codec::kRaw8 : proto::Codec::kRaw16;
  b.calib_crc32 = crc32(std::as_bytes(std::span(rig_text_.data(), rig_text_.size())));
  b.payload_crc32 = crc32(std::as_bytes(std::span(b.payload)));
  return b;
}

}  // namespace enamel::host
