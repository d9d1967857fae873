// The neutral form of bursts: folders with rig.json, bursts.csv and frames/*.png (docs/recording-format.md).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/capture/capture.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::host {

struct ExchangeRow {
  std::uint64_t burst_id = 0;
  std::array<std::int64_t, 4> t_ns{};  ///< start of exposure of each frame, device clock
  std::uint32_t exposure_us = 0;
  double temp_c = 0;
  std::string text;  ///< the line, with commas and points whatever a spreadsheet made of them
  int line = 0;      ///< 1-based
};

/// Rows in file order, ids strictly ascending; a table that a spreadsheet saved will do (protocol/base/plain_text.hpp).
/// Errors: kExchangeInvalid with file and line.
[[nodiscard]] Result<std::vector<ExchangeRow>> parse_bursts_csv(const std::string& text, const std::string& path);

/// Reads a folder burst by burst; nothing is kept in memory but the table. One thread.
class ExchangeReader {
 public:
  /// Checks the table and that every frame file exists, before the first burst is read. Errors: kFileNotFound (no such
  /// folder), kExchangeInvalid (missing rig.json, bursts.csv or frame; malformed row; axes.csv with a burst that is
  /// not there), kEmptyInput (no rows).
  [[nodiscard]] static Result<ExchangeReader> open(const std::string& folder);

  [[nodiscard]] const std::string& rig_text() const noexcept { return rig_text_; }
  [[nodiscard]] const std::vector<ExchangeRow>& rows() const noexcept { return rows_; }
  /// Burst of rows()[n]. Errors: kImageInvalid (unreadable, colour, other size or depth than the folder's first frame
  /// or the rig's camera), kExchangeInvalid.
  [[nodiscard]] Result<proto::Burst> burst(std::size_t n) const;
  /// Where the axes stood at rows()[n], from axes.csv; stops are numbered. nullopt: no such file, or no row.
  [[nodiscard]] const std::optional<proto::AxesReading>& axes(std::size_t n) const noexcept { return axes_[n]; }
  [[nodiscard]] const std::string& table_text() const noexcept { return table_text_; }
  /// Every other file of the folder, as relative paths in sorted order: truth/, notes.
  [[nodiscard]] const std::vector<std::string>& extra_files() const noexcept { return extra_files_; }
  [[nodiscard]] const std::string& folder() const noexcept { return folder_; }

 private:
  [[nodiscard]] Result<void> check_first_frame();
  [[nodiscard]] Result<void> read_axes();

  std::string folder_;
  std::string rig_text_;
  std::string table_text_;
  std::vector<ExchangeRow> rows_;
  std::vector<std::optional<proto::AxesReading>> axes_;  ///< one a row
  std::vector<std::string> extra_files_;
  int width_ = 0, height_ = 0;
  int file_bits_ = 0;  ///< of the PNG files: 8 or 16
  int rig_bits_ = 0;   ///< noise.bits of the rig, 0 when it does not say
};

/// Line of bursts.csv without its end. Needs four metas.
[[nodiscard]] std::string row_text(const proto::Burst& burst);

/// Writes a folder burst by burst. Needs RAW8 or RAW16 bursts. The table comes last, at finish(): a folder without it
/// was not finished and is refused by every reader.
class ExchangeWriter {
 public:
  /// Errors: kFileWrite, also when the folder already holds bursts.
  [[nodiscard]] static Result<ExchangeWriter> create(const std::string& folder, const std::string& rig_text);
  /// Errors: kImageInvalid (inconsistent burst or coded payload), kFileWrite.
  [[nodiscard]] Result<void> write(const proto::Burst& burst) { return write(burst, row_text(burst)); }
  /// With its line of the table, used instead of the burst's own values (keeps digits beyond 0.01 degC).
  [[nodiscard]] Result<void> write(const proto::Burst& burst, const std::string& row);
  /// Extra file by relative path. Errors: kExchangeInvalid (path leaves the folder), kFileWrite.
  [[nodiscard]] Result<void> write_file(const std::string& name, proto::ByteView bytes);
  /// `table`: the whole bursts.csv instead of the lines collected.
  [[nodiscard]] Result<void> finish(const std::optional<std::string>& table = std::nullopt);

 private:
  ExchangeWriter() = default;
  std::string folder_;
  std::string table_;
};

struct ImportSummary {
  std::uint64_t bursts = 0;
  std::uint64_t attachments = 0;
  std::uint64_t missing = 0;            ///< bursts that were in damaged places of the source
  std::vector<std::string> problems{};  ///< what is damaged there, one line each
};

/// Folder to recording without loss. On error no recording is left behind. Errors: as reader and CaptureWriter.
[[nodiscard]] Result<ImportSummary> import_folder(const std::string& folder, const std::string& capture_path,
                                                  const std::string& program);
/// Recording to folder; what import_folder stored comes back byte for byte. Of a damaged recording what is whole.
[[nodiscard]] Result<ImportSummary> export_folder(const std::string& capture_path, const std::string& folder);

}  // namespace enamel::host
