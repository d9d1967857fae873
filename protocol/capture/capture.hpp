// Recordings: one MCAP file with the messages as they were on the wire, what was shed, and everything needed to process
// it again (rig.json, configuration, truth). Layout: docs/recording-format.md. No DDS.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/types/cdr.hpp"

namespace enamel::capture {

/// Names of attachments with a meaning of their own.
inline constexpr const char* kRigAttachment = "rig.json";
inline constexpr const char* kConfigAttachment = "config.toml";

using KeyValues = std::vector<std::pair<std::string, std::string>>;

struct CaptureHeader {
  std::string rig_text;  ///< rig.json byte for byte; empty when unknown
  std::string program;   ///< "enamel 0.1.0"
  KeyValues metadata;    ///< free: session, seed, compiler … (keys unique)
};

struct CaptureOptions {
  bool compress = true;                            ///< zstd, fastest level
  std::size_t chunk_bytes = std::size_t{1} << 20;  ///< a chunk is closed and handed to the system once it is this long:
                                                   ///< with VGA bursts one burst a chunk, so a kill loses at most one
};

/// Writes one recording. One thread. After a failed write (disk full) the file is cut back to its last whole chunk and
/// stays readable; that call returns kFileWrite, later records are counted in dropped() and finish() says kFileWrite
/// again.
class CaptureWriter {
 public:
  /// Makes the file (an existing one is replaced). Errors: kFileWrite.
  [[nodiscard]] static Result<CaptureWriter> create(const std::string& path, const CaptureHeader& header,
                                                    const CaptureOptions& options = {});
  CaptureWriter(CaptureWriter&&) noexcept;
  CaptureWriter& operator=(CaptureWriter&&) noexcept;
  ~CaptureWriter();  ///< without finish(): flushes whole chunks, no summary; the file opens as truncated

  /// log_ns: host monotonic clock at reception, not decreasing within a file; replay order is the order of writing.
  /// Errors: kMessageInvalid (value exceeds a bound, nothing written), kFileWrite.
  [[nodiscard]] Result<void> write_burst(const proto::Burst& burst, std::int64_t log_ns);
  /// The same from the bytes as received. They are stored as they are; only the first fields are looked at.
  [[nodiscard]] Result<void> write_burst_cdr(proto::ByteView cdr, std::int64_t log_ns);
  [[nodiscard]] Result<void> write_shed(const proto::ShedNote& note, std::int64_t log_ns);
  [[nodiscard]] Result<void> write_status(const proto::Status& status, std::int64_t log_ns);
  [[nodiscard]] Result<void> write_event(const proto::Event& event, std::int64_t log_ns);
  [[nodiscard]] Result<void> write_device_info(const proto::DeviceInfo& info, std::int64_t log_ns);
  /// Best in front of its burst, so that both lie in one chunk. A recording without readings is without their channel.
  [[nodiscard]] Result<void> write_axes(const proto::AxesReading& reading, std::int64_t log_ns);
  /// Any time before finish(). Names are unique relative paths ("truth/poses.csv").
  [[nodiscard]] Result<void> attach(const std::string& name, const std::string& media_type, proto::ByteView bytes);
  /// Hands what is pending to the system now.
  [[nodiscard]] Result<void> flush();
  /// Index, summary, footer; closes the file. Errors: kFileWrite.
  [[nodiscard]] Result<void> finish();

  [[nodiscard]] bool failed() const noexcept;
  [[nodiscard]] std::uint64_t dropped() const noexcept;  ///< records refused since the failure

 private:
  struct Impl;
  explicit CaptureWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

struct AttachmentInfo {
  std::string name;
  std::string media_type;
  std::uint64_t size = 0;
};

struct CaptureInfo {
  /// As many as were written, where the summary or the indexes tell; a damaged file delivers fewer.
  std::uint64_t bursts = 0, shed = 0, statuses = 0, events = 0, device_infos = 0, axes = 0;
  std::int64_t first_log_ns = 0, last_log_ns = 0;  ///< 0, 0 when empty
  bool truncated = false;  ///< no footer: the writer was killed or the disk filled up; what is whole is readable
  std::uint64_t file_bytes = 0;
  std::string program;
  KeyValues metadata;
  std::vector<AttachmentInfo> attachments;
  std::vector<std::string> problems;  ///< damage that takes no record along (header, summary), one line each
  [[nodiscard]] std::int64_t duration_ns() const noexcept { return last_log_ns - first_log_ns; }
};

struct Record {
  std::int64_t log_ns = 0;
  std::variant<proto::Burst, proto::ShedNote, proto::Status, proto::Event, proto::DeviceInfo, proto::AxesReading>
      value{};
  friend bool operator==(const Record&, const Record&) = default;
};

/// Reads one recording. One thread. Every length is checked and every chunk's CRC verified before it is used; what is
/// whole is delivered wherever the damage lies.
class CaptureReader {
 public:
  /// Errors: kFileNotFound, kFileRead, kCaptureInvalid (empty, foreign, nothing whole in it). A truncated or damaged
  /// file opens; info() and next() say what is wrong with it.
  [[nodiscard]] static Result<CaptureReader> open(const std::string& path);
  CaptureReader(CaptureReader&&) noexcept;
  CaptureReader& operator=(CaptureReader&&) noexcept;
  ~CaptureReader();

  [[nodiscard]] const CaptureInfo& info() const noexcept;
  [[nodiscard]] const std::string& rig_text() const noexcept;  ///< empty when the recording carries none
  /// Errors: kFileNotFound (no such attachment), kCaptureCorrupt.
  [[nodiscard]] Result<proto::Bytes> attachment(const std::string& name);

  /// Next record in log order, nullopt at the end. Errors: kCaptureCorrupt (names the chunk), kCaptureInvalid (a
  /// compression that is not read here), kMessageInvalid; the
  /// record in question is passed over and the next call goes on behind it (behind its chunk when that is damaged).
  /// Bursts that the summary counts and no place accounts for are one error more, at the end.
  [[nodiscard]] Result<std::optional<Record>> next();
  /// As next(), skipping everything that is not a burst.
  [[nodiscard]] Result<std::optional<proto::Burst>> next_burst();
  /// Bursts that the errors of next() have taken along so far.
  [[nodiscard]] std::uint64_t bursts_lost() const noexcept;
  void rewind() noexcept;

  /// n-th burst of the file, 0-based; does not move next(). Errors: kBurstNotFound, kCaptureCorrupt.
  [[nodiscard]] Result<proto::Burst> burst(std::uint64_t ordinal);
  /// Burst with this burst_index (the first one, should it occur twice). Errors as burst().
  [[nodiscard]] Result<proto::Burst> burst_with_id(BurstId id);

 private:
  struct Impl;
  explicit CaptureReader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::capture
