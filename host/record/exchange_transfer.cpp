// Folder to recording and back.
#include <algorithm>

#include "host/record/axes_gather.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "host/record/media_type.hpp"
#include "host/record/partial_file.hpp"
#include "protocol/base/file.hpp"

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

/// What export_bursts looks at and adds to.
struct Export {
  OriginalTable table;
  AxesGather axes;
  ImportSummary summary{};
};

Result<void> export_bursts(BurstStream& stream, Export& run, ExchangeWriter& out) {
  ImportSummary& summary = run.summary;
  for (;;) {
    const auto record = stream.next();
    if (!record) {
      if (record.error().code == ErrorCode::kFileRead) return tl::unexpected<Error>(record.error());
      summary.problems.push_back(record.error().detail);
      continue;
    }
    if (!*record) break;
    const auto* burst = std::get_if<proto::Burst>(&(*record)->value);
    if (burst == nullptr) {
      run.axes.take(**record);
      continue;
    }
    if (!proto::is_consistent(*burst)) {
      ++summary.missing;
      summary.problems.push_back("burst " + std::to_string(burst->burst_index) + ": its parts do not fit together");
      continue;
    }
    ENAMEL_TRY(out.write(*burst, run.table.line_for(*burst)));
    run.axes.take(**record);
    ++summary.bursts;
  }
  summary.missing += stream.bursts_lost();
  return {};
}

}  // namespace

Result<ImportSummary> import_folder(const std::string& folder, const std::string& capture_path,
                                    const std::string& program) {
  ENAMEL_TRY_ASSIGN(const ExchangeReader in, ExchangeReader::open(folder));
  PartialFile file(capture_path);
  capture::CaptureHeader header{in.rig_text(), program, {{"imported_from", "exchange folder"}}};
  ENAMEL_TRY_ASSIGN(auto out, capture::CaptureWriter::create(file.temporary(), header));
  for (std::size_t n = 0; n < in.rows().size(); ++n) {
    ENAMEL_TRY_ASSIGN(const proto::Burst burst, in.burst(n));
    const std::int64_t log_ns = row_end_ns(in.rows()[n]);
    if (in.axes(n)) ENAMEL_TRY(out.write_axes(*in.axes(n), log_ns));
    ENAMEL_TRY(out.write_burst(burst, log_ns));
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
  Export run{.table = OriginalTable(*stream), .axes = AxesGather(*stream)};
  ImportSummary& summary = run.summary;
  summary.problems = stream->info().problems;
  for (const capture::AttachmentInfo& attachment : stream->info().attachments) {
    ++summary.attachments;
    if (attachment.name == kRigFile || attachment.name == kTableFile) continue;
    const auto bytes = stream->attachment(attachment.name);
    if (!bytes) {
      summary.problems.push_back(bytes.error().detail);
      continue;
    }
    // Written from the channel, below.
    if (attachment.name != kAxesFile) ENAMEL_TRY(out.write_file(attachment.name, *bytes));
  }
  ENAMEL_TRY(export_bursts(*stream, run, out));
  if (const auto wrong = run.axes.contradiction()) summary.problems.push_back(wrong->detail);
  if (const auto axes = run.axes.table()) ENAMEL_TRY(out.write_file(kAxesFile, as_octets(*axes)));
  ENAMEL_TRY(out.finish(run.table.whole()));
  return summary;
}

}  // namespace enamel::host
