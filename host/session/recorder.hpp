// Writes the session's recording: what passed the ingress gate, as it was on the wire, and what the probe and the gate
// had to say meanwhile.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/base/time.hpp"
#include "protocol/capture/capture.hpp"

namespace enamel::host {

/// Of a recording that begins now.
[[nodiscard]] capture::CaptureHeader header_of(const proto::DeviceInfo& info, const std::string& rig_text,
                                               const std::string& program);

class Recorder {
 public:
  /// Errors: kFileWrite.
  [[nodiscard]] static Result<std::unique_ptr<Recorder>> create(const std::string& path,
                                                                const capture::CaptureHeader& header);

  using Note = std::variant<proto::ShedNote, proto::Status, proto::Event, proto::DeviceInfo>;
  /// Thread-safe: kept until the next burst or finish().
  void note(Note note, HostTime when);

  /// One thread. A disk that fails stops the recording, not the scan: error() tells from then on.
  void write_burst(proto::ByteView cdr, HostTime when);
  /// Angles at which the burst that follows was taken; of the same thread.
  void write_axes(const proto::AxesReading& reading, HostTime when);
  void attach(const std::string& name, const std::string& media_type, const std::string& bytes);
  void finish();

  /// First failure, if any; the recording holds everything before it.
  [[nodiscard]] std::optional<Error> error() const;

 private:
  explicit Recorder(capture::CaptureWriter writer) : writer_(std::move(writer)) {}
  void drain_notes();
  void keep(const Result<void>& result);
  [[nodiscard]] std::int64_t monotone(HostTime when);

  capture::CaptureWriter writer_;
  std::int64_t last_ns_ = 0;
  mutable std::mutex mutex_;  // guards notes_ and error_
  std::vector<std::pair<Note, HostTime>> notes_;
  std::optional<Error> error_;
};

}  // namespace enamel::host
