#include <algorithm>

#include "host/record/capture_tools.hpp"
#include "host/record/partial_file.hpp"
#include "protocol/capture/capture.hpp"

namespace enamel::host {
namespace {

Result<void> copy_record(capture::CaptureWriter& out, const capture::Record& record) {
  struct Copy {
    capture::CaptureWriter& out;
    std::int64_t log_ns;
    Result<void> operator()(const proto::Burst& v) const { return out.write_burst(v, log_ns); }
    Result<void> operator()(const proto::ShedNote& v) const { return out.write_shed(v, log_ns); }
    Result<void> operator()(const proto::Status& v) const { return out.write_status(v, log_ns); }
    Result<void> operator()(const proto::Event& v) const { return out.write_event(v, log_ns); }
    Result<void> operator()(const proto::DeviceInfo& v) const { return out.write_device_info(v, log_ns); }
    Result<void> operator()(const proto::AxesReading& v) const { return out.write_axes(v, log_ns); }
  };
  return std::visit(Copy{out, record.log_ns}, record.value);
}

// Copies from the first to the last burst of the range; what was logged between them goes along. Angles go with their
// burst, wherever they were logged.
class RangeCopy {
 public:
  RangeCopy(capture::CaptureWriter& out, std::uint64_t first, std::uint64_t last)
      : out_(out), first_(first), last_(last) {}

  [[nodiscard]] Result<void> take(capture::Record record) {
    if (const auto* reading = std::get_if<proto::AxesReading>(&record.value)) {
      if (is_inside(reading->burst_index)) pending_.push_back(std::move(record));
      return {};
    }
    const auto* burst = std::get_if<proto::Burst>(&record.value);
    if (burst == nullptr) {
      const bool device = std::holds_alternative<proto::DeviceInfo>(record.value);
      if (copied_ > 0) {
        pending_.push_back(std::move(record));
      } else if (device) {
        std::erase_if(pending_, [](const capture::Record& p) { return !is_reading(p); });
        pending_.push_back(std::move(record));  // which probe the bursts are from
      }
      return {};
    }
    if (!is_inside(burst->burst_index)) return {};
    for (const capture::Record& p : pending_) ENAMEL_TRY(copy_record(out_, p));
    pending_.clear();
    ++copied_;
    return copy_record(out_, record);
  }
  [[nodiscard]] Result<void> finish() {
    for (const capture::Record& p : pending_) {
      if (is_reading(p)) ENAMEL_TRY(copy_record(out_, p));
    }
    return {};
  }
  [[nodiscard]] std::uint64_t copied() const noexcept { return copied_; }

 private:
  [[nodiscard]] bool is_inside(std::uint64_t burst) const noexcept { return burst >= first_ && burst <= last_; }
  [[nodiscard]] static bool is_reading(const capture::Record& record) {
    return std::holds_alternative<proto::AxesReading>(record.value);
  }

  capture::CaptureWriter& out_;
  std::uint64_t first_, last_;
  std::uint64_t copied_ = 0;
  std::vector<capture::Record> pending_;
};

// Copies every record that it is given.
class WholeCopy {
 public:
  explicit WholeCopy(capture::CaptureWriter& out) : out_(out) {}

  [[nodiscard]] Result<void> take(capture::Record record) {
    const bool burst = std::holds_alternative<proto::Burst>(record.value);
    copied_ += burst ? 1 : 0;
    return copy_record(out_, record);
  }
  [[nodiscard]] Result<void> finish() const { return {}; }
  [[nodiscard]] std::uint64_t copied() const noexcept { return copied_; }

 private:
  capture::CaptureWriter& out_;
  std::uint64_t copied_ = 0;
};

void note(CopySummary& summary, const std::string& problem) {
  if (summary.problems.size() < kMaxProblems) summary.problems.push_back(problem);
}

// A burst whose fields or payload do not fit together is damaged like one that cannot be read.
bool whole(const capture::Record& record, CopySummary& summary) {
  const auto* burst = std::get_if<proto::Burst>(&record.value);
  if (burst == nullptr || proto::is_consistent(*burst)) return true;
  ++summary.missing;
  note(summary, "burst " + std::to_string(burst->burst_index) + ": sizes, frames, times or payload CRC do not fit");
  return false;
}

template <class Copy>
Result<void> copy_records(capture::CaptureReader& reader, Copy& copy, CopySummary& summary) {
  for (;;) {
    auto record = reader.next();
    if (!record) {
      // Not of the file's bytes: it would come again and again.
      if (record.error().code == ErrorCode::kFileRead) return tl::unexpected<Error>(record.error());
      note(summary, record.error().detail);
      continue;
    }
    if (!*record) break;
    if (whole(**record, summary)) ENAMEL_TRY(copy.take(std::move(**record)));
  }
  summary.missing += reader.bursts_lost();
  return copy.finish();
}

Result<void> copy_attachments(capture::CaptureReader& reader, capture::CaptureWriter& writer, CopySummary& summary) {
  for (const capture::AttachmentInfo& a : reader.info().attachments) {
    if (a.name == capture::kRigAttachment) continue;
    const auto bytes = reader.attachment(a.name);
    if (!bytes) {
      note(summary, bytes.error().detail);
      continue;
    }
    ENAMEL_TRY(writer.attach(a.name, a.media_type, *bytes));
  }
  return {};
}

struct CopyRun {
  const std::string& in;
  const std::string& out;
  const char* key;  ///< what is said of the copy in its metadata
  std::string value;
};

template <class MakeCopy>
Result<CopySummary> copy_recording(const CopyRun& run, MakeCopy&& make) {
  ENAMEL_TRY_ASSIGN(auto reader, capture::CaptureReader::open(run.in));
  CopySummary summary;
  summary.problems = reader.info().problems;
  capture::CaptureHeader header{reader.rig_text(), reader.info().program, reader.info().metadata};
  std::erase_if(header.metadata, [&](const auto& entry) { return entry.first == run.key; });
  header.metadata.emplace_back(run.key, run.value);
  PartialFile file(run.out);
  ENAMEL_TRY_ASSIGN(auto writer, capture::CaptureWriter::create(file.temporary(), header));
  auto copy = make(writer);
  ENAMEL_TRY(copy_records(reader, copy, summary));
  summary.bursts = copy.copied();
  if (summary.bursts == 0) return summary;
  ENAMEL_TRY(copy_attachments(reader, writer, summary));
  ENAMEL_TRY(writer.finish());
  ENAMEL_TRY(file.commit());
  return summary;
}

}  // namespace

Result<CopySummary> capture_cut(const std::string& in, const std::string& out, std::uint64_t first,
                                std::uint64_t last) {
  const std::string range = std::to_string(first) + "-" + std::to_string(last);
  ENAMEL_TRY_ASSIGN(const auto summary, copy_recording({in, out, "cut", range}, [&](capture::CaptureWriter& w) {
                      return RangeCopy(w, first, last);
                    }));
  if (summary.bursts == 0) {
    return fail(ErrorCode::kBurstNotFound,
                in + ": no burst from " + std::to_string(first) + " to " + std::to_string(last));
  }
  return summary;
}

Result<CopySummary> capture_repair(const std::string& in, const std::string& out) {
  ENAMEL_TRY_ASSIGN(const auto summary, copy_recording({in, out, "repaired", "what was whole"},
                                                       [](capture::CaptureWriter& w) { return WholeCopy(w); }));
  if (summary.bursts == 0) return fail(ErrorCode::kEmptyInput, in + ": no burst of it is whole");
  return summary;
}

}  // namespace enamel::host
