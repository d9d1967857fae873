#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "host/record/axes_gather.hpp"
#include "host/record/burst_stream.hpp"
#include "host/record/capture_tools.hpp"
#include "protocol/base/crc32.hpp"
#include "protocol/mcap/reader.hpp"

namespace enamel::host {
namespace {

class Verifier {
 public:
  explicit Verifier(BurstStream& stream) : stream_(stream), axes_(stream) {
    report_.truncated = stream.info().truncated;
    for (const std::string& damage : stream.info().problems) problem(damage);
    const std::string& rig = stream.rig_text();
    if (rig.empty()) problem("no rig.json in the recording");
    rig_crc_ = crc32(std::as_bytes(std::span(rig.data(), rig.size())));
  }

  void read_all() {
    // A damaged chunk gives one error each, so the number of errors is bounded by the file.
    for (;;) {
      const auto record = stream_.next();
      if (!record) {
        problem(record.error().detail);
        unreadable_ = true;
        continue;
      }
      if (!*record) break;
      take(**record);
    }
    if (!unreadable_ && seen_bursts_ != stream_.info().bursts) {
      problem("summary counts " + std::to_string(stream_.info().bursts) + " bursts, the file holds " +
              std::to_string(seen_bursts_));
    }
    if (const auto wrong = axes_.contradiction()) problem(wrong->detail);
    for (const capture::AttachmentInfo& a : stream_.info().attachments) {
      if (const auto bytes = stream_.attachment(a.name); !bytes) problem(bytes.error().detail);
    }
  }
  void problem(const std::string& what) {
    if (report_.problems.size() < kMaxProblems) report_.problems.push_back(what);
  }
  [[nodiscard]] VerifyReport report() const { return report_; }

 private:
  void take(const capture::Record& record) {
    ++report_.records;
    if (report_.records > 1 && record.log_ns < last_log_ns_) {
      problem("record " + std::to_string(report_.records - 1) + " was logged before the one in front of it");
    }
    last_log_ns_ = record.log_ns;
    axes_.take(record);
    if (const auto* status = std::get_if<proto::Status>(&record.value)) take(*status);
    if (const auto* burst = std::get_if<proto::Burst>(&record.value)) take(*burst);
  }

  /// A probe that was started again counts from zero, its words as well as its bursts.
  void take(const proto::Status& status) {
    if (status.seq < last_status_) last_index_.reset();
    last_status_ = status.seq;
  }

  void take(const proto::Burst& burst) {
    ++seen_bursts_;
    const std::string name = "burst " + std::to_string(burst.burst_index);
    if (proto::is_consistent(burst)) {
      ++report_.bursts;
    } else {
      problem(name + ": sizes, frames, times or payload CRC do not fit together");
    }
    if (last_index_ && burst.burst_index <= *last_index_) problem(name + ": number does not ascend");
    last_index_ = burst.burst_index;
    if (!stream_.rig_text().empty() && burst.calib_crc32 != 0 && burst.calib_crc32 != rig_crc_ && !rig_told_) {
      problem(name + ": names another calibration than the rig.json in the recording");
      rig_told_ = true;
    }
  }

  BurstStream& stream_;
  AxesGather axes_;
  VerifyReport report_;
  std::uint32_t rig_crc_ = 0;
  std::uint64_t seen_bursts_ = 0;
  std::optional<std::uint64_t> last_index_;  ///< of a burst of the probe's life
  std::uint32_t last_status_ = 0;
  std::int64_t last_log_ns_ = 0;
  bool unreadable_ = false, rig_told_ = false;
};

}  // namespace

Result<VerifyReport> capture_verify(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const auto stream, open_bursts(path));
  Verifier verifier(*stream);
  verifier.read_all();
  std::error_code ec;
  if (!std::filesystem::is_directory(path, ec)) {
    ENAMEL_TRY_ASSIGN(const mcap::Reader file, mcap::Reader::open(path));
    // Every damage shows here; said only when no finer check has named its place.
    const auto whole = file.verify_data_section();
    if (!whole && verifier.report().problems.empty()) verifier.problem(whole.error().detail);
  }
  return verifier.report();
}

}  // namespace enamel::host
