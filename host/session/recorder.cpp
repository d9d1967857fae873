#include "host/session/recorder.hpp"

#include <algorithm>

#include "host/record/calibration_attachment.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/utc.hpp"

namespace enamel::host {

capture::CaptureHeader header_of(const proto::DeviceInfo& info, const std::string& rig_text,
                                 const std::string& program) {
  return {rig_text, program, {{"serial", info.serial}, {"model", info.model}, {kRecordedAt, utc_text(wall_time())}}};
}

Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& path, const capture::CaptureHeader& header) {
  ENAMEL_TRY_ASSIGN(auto writer, capture::CaptureWriter::create(path, header));
  return std::unique_ptr<Recorder>(new Recorder(std::move(writer)));
}

void Recorder::note(Note note, HostTime when) {
  const std::lock_guard lock(mutex_);
  notes_.emplace_back(std::move(note), when);
}

// Notes are stamped on the ingest thread and written on this one; a recording's times do not decrease.
std::int64_t Recorder::monotone(HostTime when) {
  last_ns_ = std::max(last_ns_, to_ns(when));
  return last_ns_;
}

void Recorder::keep(const Result<void>& result) {
  if (result) return;
  const std::lock_guard lock(mutex_);
  if (error_) return;
  error_ = result.error();
  log::error("record", "{}", error_->message());
}

void Recorder::drain_notes() {
  std::vector<std::pair<Note, HostTime>> notes;
  {
    const std::lock_guard lock(mutex_);
    notes.swap(notes_);
  }
  for (const auto& [note, when] : notes) {
    const std::int64_t ns = monotone(when);
    if (const auto* shed = std::get_if<proto::ShedNote>(&note)) keep(writer_.write_shed(*shed, ns));
    if (const auto* status = std::get_if<proto::Status>(&note)) keep(writer_.write_status(*status, ns));
    if (const auto* event = std::get_if<proto::Event>(&note)) keep(writer_.write_event(*event, ns));
    if (const auto* info = std::get_if<proto::DeviceInfo>(&note)) keep(writer_.write_device_info(*info, ns));
  }
}

void Recorder::write_burst(proto::ByteView cdr, HostTime when) {
  drain_notes();
  keep(writer_.write_burst_cdr(cdr, monotone(when)));
}

void Recorder::write_axes(const proto::AxesReading& reading, HostTime when) {
  keep(writer_.write_axes(reading, monotone(when)));
}

void Recorder::attach(const std::string& name, const std::string& media_type, const std::string& bytes) {
  keep(writer_.attach(name, media_type, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
}

void Recorder::finish() {
  drain_notes();
  keep(writer_.finish());
}

std::optional<Error> Recorder::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

}  // namespace enamel::host
