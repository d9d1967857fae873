// Folder to recording and back.
#include <algorithm>

#include "host/record/burst_stream.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "host/record/media_type.hpp"
#include "host/record/partial_file.hpp"
#include "protocol/base/file.hpp"
#include "protocol/types/axes_table.hpp"

namespace enamel::host {
namespace {

proto::ByteView as_octets(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

bool same_values(const ExchangeRow& row, const proto::Burst& burst) {
  const auto of_burst = parse_bursts_csv(kTableHeader + row_text(burst), "burst");
  return of_burst && of_burst->size() == 1 && of_burst->front().burst_id == row.burst_id &&
         of_burst->front().t_ns == row.t_ns && of_burst->front().exposure_us == row.exposure_us;
}

// The lines of the table that was imported, as far as they still describe the bursts.
class OriginalTable {
 public:
  explicit OriginalTable(BurstStream& stream) {
    const auto bytes = stream.attachment(kTableFile);
    if (!bytes) return;
    text_.assign(bytes->begin(), bytes->end());
    if (auto rows = parse_bursts_csv(text_, kTableFile)) rows_ = std::move(*rows);
  }
  std::string line_for(const proto::Burst& burst) {
    const auto it =
        std::find_if(rows_.begin(), rows_.end(), [&](const auto& r) { return r.burst_id == burst.burst_index; });
    if (it == rows_.end() || !same_values(*it, burst)) {
      all_kept_ = false;
      return row_text(burst);
    }
    ++used_;
    return it->text;
  }
  /// The text itself when every line was used and nothing else.
  [[nodiscard]] std::optional<std::string> whole() const {
    if (!all_kept_ || used_ != rows_.size() || rows_.empty()) return std::nullopt;
    return text_;
  }

 private:
  std::string text_;
  std::vector<ExchangeRow> rows_;
  std::size_t used_ = 0;
  bool all_kept_ = true;
};

Result<void> export_bursts(BurstStream& stream, OriginalTable& table, ExchangeWriter& out, ImportSummary& summary) {
  for (;;) {
    const auto record = stream.next();
    if (!record) {
      if (record.error().code == ErrorCode::kFileRead) return tl::unexpected<Error>(record.error());
      summary.problems.push_back(record.error().detail);
      continue;
    }
    if (!*record) break;
    const auto* burst = std::get_if<proto::Burst>(&(*record)->value);
    if (burst == nullptr) continue;
    if (!proto::is_consistent(*burst)) {
      ++summary.missing;
      summary.problems.push_back("burst " + std::to_string(burst->burst_index) + ": its parts do not fit together");
      continue;
    }
    ENAMEL_TRY(out.write(*burst, table.line_for(*burst)));
    ++summary.bursts;
  }
  summary.missing += stream.bursts_lost();
  return {};
}

/// Where there is axes.csv its rows are angles of bursts that are there. Bursts without a row are taken.
Result<void> check_axes(const ExchangeReader& in, const std::string& folder) {
  if (std::ranges::find(in.extra_files(), kAxesFile) == in.extra_files().end()) return {};
  const std::string path = (std::filesystem::path(folder) / kAxesFile).string();
  ENAMEL_TRY_ASSIGN(const std::string text, read_file(path));
  ENAMEL_TRY_ASSIGN(const auto readings, proto::parse_burst_axes(text, path));
  for (const proto::AxesReading& reading : readings) {
    if (std::ranges::find(in.rows(), reading.burst_index, &ExchangeRow::burst_id) == in.rows().end())
      return fail(ErrorCode::kExchangeInvalid,
                  path + ": burst " + std::to_string(reading.burst_index) +
                      " is not in bursts.csv; it belongs to another scan, or the burst was removed");
  }
  return {};
}

}  // namespace

Result<ImportSummary> import_folder(const std::string& folder, const std::string& capture_path,
                                    const std::string& program) {
  ENAMEL_TRY_ASSIGN(const ExchangeReader in, ExchangeReader::open(folder));
  ENAMEL_TRY(check_axes(in, folder));
  PartialFile file(capture_path);
  capture::CaptureHeader header{in.rig_text(), program, {{"imported_from", "exchange folder"}}};
  ENAMEL_TRY_ASSIGN(auto out, capture::CaptureWriter::create(file.temporary(), header));
  for (std::size_t n = 0; n < in.rows().size(); ++n) {
    ENAMEL_TRY_ASSIGN(const proto::Burst burst, in.burst(n));
    ENAMEL_TRY(out.write_burst(burst, row_end_ns(in.rows()[n])));
  }
  ENAMEL_TRY(out.attach(kTableFile, "text/csv", as_octets(in.table_text())));
  for (const std::string& name : in.extra_files()) {
    ENAMEL_TRY_ASSIGN(const std::string bytes, read_file((std::filesystem::path(folder) / name).string()));
    ENAMEL_TRY(out.attach(name, media_type_of(name), as_octets(bytes)));
  }
  ENAMEL_TRY(out.finish());
  ENAMEL_TRY(file.commit());
  return ImportSummary{in.rows().size(), in.extra_files().size() + 2, 0, {}};
}

Result<ImportSummary> export_folder(const std::string& capture_path, const std::string& folder) {
  ENAMEL_TRY_ASSIGN(const auto stream, open_bursts(capture_path));
  if (stream->info().bursts == 0) return fail(ErrorCode::kEmptyInput, capture_path);
  if (stream->rig_text().empty()) return fail(ErrorCode::kRigMissing, capture_path + ": a folder needs rig.json");
  ENAMEL_TRY_ASSIGN(ExchangeWriter out, ExchangeWriter::create(folder, stream->rig_text()));
  OriginalTable table(*stream);
  ImportSummary summary;
  summary.problems = stream->info().problems;
  for (const capture::AttachmentInfo& attachment : stream->info().attachments) {
    ++summary.attachments;
    if (attachment.name == kRigFile || attachment.name == kTableFile) continue;
    const auto bytes = stream->attachment(attachment.name);
    if (!bytes) {
      summary.problems.push_back(bytes.error().detail);
      continue;
    }
    ENAMEL_TRY(out.write_file(attachment.name, *bytes));
  }
  ENAMEL_TRY(export_bursts(*stream, table, out, summary));
  ENAMEL_TRY(out.finish(table.whole()));
  return summary;
}

}  // namespace enamel::host
