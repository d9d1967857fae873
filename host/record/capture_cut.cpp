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
  };
  return std::visit(Copy{out, record.log_ns}, record.value);
}

// Copies from the first to the last burst of the range; what was logged between them goes along.
class RangeCopy {
 public:
  RangeCopy(capture::CaptureWriter& out, std::uint64_t first, std::uint64_t last)
      : out_(out), first_(first), last_(last) {}

  [[nodiscard]] Result<void> take(capture::Record record) {
    const auto* burst = std::get_if<proto::Burst>(&record.value);
    if (burst == nullptr) {
      const bool device = std::holds_alternative<proto::DeviceInfo>(record.value);
      if (copied_ > 0) {
        pending_.push_back(std::move(record));
      } else if (device) {
        pending_.clear();
        pending_.push_back(std::move(record));  // which probe the bursts are from
      }
      return {};
    }
    if (burst->burst_index < first_ || burst->burst_index > last_) return {};
    for (const capture::Record& p : pending_) ENAMEL_TRY(copy_record(out_, p));
    pending_.clear();
    ++copied_;
    return copy_record(out_, record);
  }
  [[nodiscard]] std::uint64_t copied() const noexcept { return copied_; }

 private:
  capture::CaptureWriter& out_;
  std::uint64_t first_, last_;
  std::uint64_t copied_ = 0;
  std::vector<capture::Record> pending_;
};

}  // namespace

Result<std::uint64_t> capture_cut(const std::string& in, const std::string& out, std::uint64_t first,
                                  std::uint64_t last) {
  ENAMEL_TRY_ASSIGN(auto reader, capture::CaptureReader::open(in));
  capture::CaptureHeader header{reader.rig_text(), reader.info().program, reader.info().metadata};
  std::erase_if(header.metadata, [](const auto& entry) { return entry.first == "cut"; });
  header.metadata.emplace_back("cut", std::to_string(first) + "-" + std::to_string(last));
  PartialFile file(out);
  ENAMEL_TRY_ASSIGN(auto writer, capture::CaptureWriter::create(file.temporary(), header));
  RangeCopy copy(writer, first, last);
  for (;;) {
    ENAMEL_TRY_ASSIGN(auto record, reader.next());
    if (!record) break;
    ENAMEL_TRY(copy.take(std::move(*record)));
  }
  if (copy.copied() == 0) {
    return fail(ErrorCode::kBurstNotFound,
                in + ": no burst from " + std::to_string(first) + " to " + std::to_string(last));
  }
  for (const capture::AttachmentInfo& a : reader.info().attachments) {
    if (a.name == capture::kRigAttachment) continue;
    ENAMEL_TRY_ASSIGN(const proto::Bytes bytes, reader.attachment(a.name));
    ENAMEL_TRY(writer.attach(a.name, a.media_type, bytes));
  }
  ENAMEL_TRY(writer.finish());
  ENAMEL_TRY(file.commit());
  return copy.copied();
}

}  // namespace enamel::host
