#include <cstdio>

#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "host/record/png_image.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {

namespace fs = std::filesystem;

std::string row_text(const proto::Burst& burst) {
  if (burst.meta.size() < static_cast<std::size_t>(proto::kFramesPerBurst)) return {};
  std::string row = std::to_string(burst.burst_index);
  for (std::size_t k = 0; k < proto::kFramesPerBurst; ++k) row += "," + std::to_string(burst.meta[k].t_strobe_ns);
  row += "," + std::to_string(burst.meta[0].exposure_us);
  const int centi = burst.temp_centi_c;
  const int magnitude = centi < 0 ? -centi : centi;
  const std::string hundredths = std::to_string(100 + magnitude % 100).substr(1);
  return row + "," + (centi < 0 ? "-" : "") + std::to_string(magnitude / 100) + "." + hundredths;
}

Result<ExchangeWriter> ExchangeWriter::create(const std::string& folder, const std::string& rig_text) {
  std::error_code ec;
  if (fs::exists(fs::path(folder) / kTableFile, ec)) {
    return fail(ErrorCode::kFileWrite, folder + " already holds bursts");
  }
  ENAMEL_TRY(make_folder((fs::path(folder) / "frames").string()));
  if (!rig_text.empty()) ENAMEL_TRY(enamel::write_file((fs::path(folder) / kRigFile).string(), rig_text));
  ExchangeWriter writer;
  writer.folder_ = folder;
  writer.table_ = kTableHeader;
  return writer;
}

Result<void> ExchangeWriter::write(const proto::Burst& burst, const std::string& row) {
  if (!proto::is_consistent(burst)) {
    return fail(ErrorCode::kImageInvalid, "burst " + std::to_string(burst.burst_index) + " is damaged or coded");
  }
  for (int k = 0; k < proto::kFramesPerBurst; ++k) {
    const std::string path = (fs::path(folder_) / frame_file(burst.burst_index, k)).string();
    ENAMEL_TRY(write_grey_png(path, burst.width, burst.height, burst.bit_depth, proto::frame_bytes(burst, k)));
  }
  table_ += row + "\n";
  return {};
}

Result<void> ExchangeWriter::write_file(const std::string& name, proto::ByteView bytes) {
  if (!is_safe_relative(name)) {
    return fail(ErrorCode::kExchangeInvalid, "attachment '" + name + "' would leave the folder");
  }
  const fs::path path = fs::path(folder_) / name;
  ENAMEL_TRY(make_folder(path.parent_path().string()));
  return enamel::write_file(path.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

Result<void> ExchangeWriter::finish(const std::optional<std::string>& table) {
  return enamel::write_file((fs::path(folder_) / kTableFile).string(), table.value_or(table_));
}

}  // namespace enamel::host
