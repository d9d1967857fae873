#include "host/record/burst_stream.hpp"

#include <algorithm>
#include <filesystem>

#include "host/record/calibration_attachment.hpp"
#include "host/record/exchange_folder.hpp"
#include "host/record/exchange_names.hpp"
#include "host/record/media_type.hpp"
#include "host/record/session_stream.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {
namespace {

class CaptureStream final : public BurstStream {
 public:
  explicit CaptureStream(capture::CaptureReader reader) : reader_(std::move(reader)) {}
  [[nodiscard]] const capture::CaptureInfo& info() const noexcept override { return reader_.info(); }
  [[nodiscard]] const std::string& rig_text() const noexcept override { return reader_.rig_text(); }
  [[nodiscard]] Result<std::optional<capture::Record>> next() override { return reader_.next(); }
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept override { return reader_.bursts_lost(); }
  void rewind() noexcept override { reader_.rewind(); }
  [[nodiscard]] Result<proto::Burst> burst_with_id(BurstId id) override { return reader_.burst_with_id(id); }
  [[nodiscard]] Result<proto::Bytes> attachment(const std::string& name) override { return reader_.attachment(name); }

 private:
  capture::CaptureReader reader_;
};

class FolderStream final : public BurstStream {
 public:
  explicit FolderStream(ExchangeReader reader) : reader_(std::move(reader)) {
    info_.bursts = reader_.rows().size();
    info_.first_log_ns = row_end_ns(reader_.rows().front());
    info_.last_log_ns = row_end_ns(reader_.rows().back());
    for (std::size_t n = 0; n < reader_.rows().size(); ++n) info_.axes += reader_.axes(n) ? 1U : 0U;
    add_attachment(kRigFile);
    add_attachment(kTableFile);
    for (const std::string& name : reader_.extra_files()) add_attachment(name);
  }
  [[nodiscard]] const capture::CaptureInfo& info() const noexcept override { return info_; }
  [[nodiscard]] const std::string& rig_text() const noexcept override { return reader_.rig_text(); }
  [[nodiscard]] Result<std::optional<capture::Record>> next() override {
    if (next_ >= reader_.rows().size()) return std::optional<capture::Record>{};
    if (reader_.axes(next_) && !axes_told_) {
      axes_told_ = true;
      return std::optional<capture::Record>(capture::Record{row_end_ns(reader_.rows()[next_]), *reader_.axes(next_)});
    }
    axes_told_ = false;
    const std::size_t n = next_++;
    auto burst = reader_.burst(n);
    if (!burst) {
      ++lost_;
      return tl::unexpected<Error>(std::move(burst).error());
    }
    return std::optional<capture::Record>(capture::Record{row_end_ns(reader_.rows()[n]), std::move(*burst)});
  }
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept override { return lost_; }
  void rewind() noexcept override {
    next_ = 0;
    axes_told_ = false;
    lost_ = 0;
  }
  [[nodiscard]] Result<proto::Burst> burst_with_id(BurstId id) override {
    const auto& rows = reader_.rows();
    const auto it = std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.burst_id == id.value; });
    if (it == rows.end()) {
      return fail(ErrorCode::kBurstNotFound, reader_.folder() + ": no burst " + std::to_string(id.value) +
                                                 "; it holds " + std::to_string(rows.size()) + " bursts");
    }
    return reader_.burst(static_cast<std::size_t>(it - rows.begin()));
  }
  [[nodiscard]] Result<proto::Bytes> attachment(const std::string& name) override {
    const auto is_it = [&](const capture::AttachmentInfo& a) { return a.name == name; };
    if (std::none_of(info_.attachments.begin(), info_.attachments.end(), is_it)) {
      return fail(ErrorCode::kFileNotFound, reader_.folder() + ": no file '" + name + "'");
    }
    ENAMEL_TRY_ASSIGN(const std::string bytes, read_file((std::filesystem::path(reader_.folder()) / name).string()));
    return proto::Bytes(bytes.begin(), bytes.end());
  }

 private:
  void add_attachment(const std::string& name) {
    std::error_code ec;
    const auto size = std::filesystem::file_size(std::filesystem::path(reader_.folder()) / name, ec);
    info_.attachments.push_back({name, media_type_of(name), ec ? 0 : size});
    info_.file_bytes += ec ? 0 : size;
  }

  ExchangeReader reader_;
  capture::CaptureInfo info_;
  std::size_t next_ = 0;
  bool axes_told_ = false;  ///< of the next burst
  std::uint64_t lost_ = 0;
};

}  // namespace

Result<std::unique_ptr<BurstStream>> open_bursts(const std::string& path) {
  std::error_code ec;
  if (std::filesystem::is_directory(path, ec)) {
    const auto parts = session_parts(path);
    if (!parts.empty()) return open_parts(parts);
    ENAMEL_TRY_ASSIGN(ExchangeReader reader, ExchangeReader::open(path));
    return std::unique_ptr<BurstStream>(std::make_unique<FolderStream>(std::move(reader)));
  }
  ENAMEL_TRY_ASSIGN(capture::CaptureReader reader, capture::CaptureReader::open(path));
  return std::unique_ptr<BurstStream>(std::make_unique<CaptureStream>(std::move(reader)));
}

std::string recorded_at(const capture::CaptureInfo& info) {
  for (const auto& [key, value] : info.metadata)
    if (key == kRecordedAt) return value;
  return {};
}

bool says_simulated(const capture::CaptureInfo& info) {
  return std::any_of(info.metadata.begin(), info.metadata.end(), [](const auto& entry) {
    return entry.first == "simulated" || entry.second.find("SIMULATED") != std::string::npos;
  });
}

}  // namespace enamel::host
