#include "protocol/mcap/writer.hpp"

#include <algorithm>
#include <array>

#include "protocol/base/bytes.hpp"
#include "protocol/capture/capture.hpp"
#include "protocol/capture/layout.hpp"
#include "protocol/types/idl_text.hpp"

namespace enamel::capture {
namespace {

struct Stamp {
  std::uint32_t sequence = 0;
  std::uint64_t publish_ns = 0;
};

// The burst's first members, from its bytes.
Result<Stamp> burst_stamp(proto::ByteView cdr) {
  ByteReader in(std::as_bytes(cdr));
  in.skip(4 + 4 + 4);  // encapsulation, probe_id, session_id
  const auto seq = in.get<std::uint64_t>();
  in.skip(sizeof(std::uint64_t) + sizeof(std::uint64_t));  // burst_index, t_first_exposure_ns
  const auto publish_ns = in.get<std::uint64_t>();
  if (!in.ok()) return fail(ErrorCode::kMessageInvalid, "burst is cut short");
  return Stamp{static_cast<std::uint32_t>(seq), publish_ns};
}

}  // namespace

struct CaptureWriter::Impl {
  mcap::Writer out;
  std::array<std::uint16_t, kKinds> channels{};
  std::array<std::uint32_t, kKinds> sequences{};
  std::vector<std::string> attachment_names;
  std::uint64_t dropped = 0;
  bool reported = false;

  explicit Impl(mcap::Writer writer) : out(std::move(writer)) {}
  Result<void> add_channel(Kind kind);
  Result<void> add_channels();
  Result<void> write(Kind kind, proto::ByteView cdr, std::int64_t log_ns, const Stamp& stamp);
  template <class T>
  Result<void> write_message(Kind kind, const T& value, std::int64_t log_ns, std::uint64_t publish_ns);
  Result<void> once(Result<void> result);
};

Result<void> CaptureWriter::Impl::add_channel(Kind kind) {
  const auto k = static_cast<std::size_t>(kind);
  const ChannelName& name = kChannelNames[k];
  ENAMEL_TRY_ASSIGN(const auto schema, out.add_schema(name.schema, kSchemaEncoding, proto::idl_text()));
  ENAMEL_TRY_ASSIGN(channels[k], out.add_channel(schema, name.topic, kMessageEncoding));
  return {};
}

// All but that of the axes, which only a desktop scanner has.
Result<void> CaptureWriter::Impl::add_channels() {
  for (const Kind kind : {Kind::kBurst, Kind::kShed, Kind::kStatus, Kind::kEvent, Kind::kDeviceInfo})
    ENAMEL_TRY(add_channel(kind));
  return {};
}

// The first failure goes to the caller; what comes after it is counted, not reported again for every record.
Result<void> CaptureWriter::Impl::once(Result<void> result) {
  if (result || !out.failed()) return result;
  if (reported) {
    ++dropped;
    return {};
  }
  reported = true;
  return result;
}

Result<void> CaptureWriter::Impl::write(Kind kind, proto::ByteView cdr, std::int64_t log_ns, const Stamp& stamp) {
  const mcap::MessageHeader header{channels[static_cast<std::size_t>(kind)], stamp.sequence,
                                   static_cast<std::uint64_t>(log_ns), stamp.publish_ns};
  ENAMEL_TRY(once(out.write_message(header, std::as_bytes(cdr))));
  // A burst is worth its own chunk: a kill then loses at most the one that is being written.
  if (kind == Kind::kBurst && !out.failed()) return once(out.flush());
  return {};
}

template <class T>
Result<void> CaptureWriter::Impl::write_message(Kind kind, const T& value, std::int64_t log_ns,
                                                std::uint64_t publish_ns) {
  ENAMEL_TRY_ASSIGN(const proto::Bytes cdr, proto::to_cdr(value));
  return write(kind, cdr, log_ns, {sequences[static_cast<std::size_t>(kind)]++, publish_ns});
}

CaptureWriter::CaptureWriter(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
CaptureWriter::CaptureWriter(CaptureWriter&&) noexcept = default;
CaptureWriter& CaptureWriter::operator=(CaptureWriter&&) noexcept = default;
CaptureWriter::~CaptureWriter() = default;

Result<CaptureWriter> CaptureWriter::create(const std::string& path, const CaptureHeader& header,
                                            const CaptureOptions& options) {
  mcap::WriterOptions mcap_options;
  mcap_options.profile = kProfile;
  mcap_options.library = header.program;
  mcap_options.compress = options.compress;
  mcap_options.chunk_bytes = options.chunk_bytes;
  ENAMEL_TRY_ASSIGN(mcap::Writer out, mcap::Writer::create(path, mcap_options));
  auto impl = std::make_unique<Impl>(std::move(out));
  ENAMEL_TRY(impl->add_channels());
  mcap::Metadata metadata{kMetadataName, {{kProgramKey, header.program}}};
  metadata.values.insert(metadata.values.end(), header.metadata.begin(), header.metadata.end());
  ENAMEL_TRY(impl->out.write_metadata(metadata));
  CaptureWriter writer(std::move(impl));
  if (!header.rig_text.empty()) {
    const auto bytes = std::span(reinterpret_cast<const std::uint8_t*>(header.rig_text.data()), header.rig_text.size());
    ENAMEL_TRY(writer.attach(kRigAttachment, "application/json", bytes));
  }
  return writer;
}

Result<void> CaptureWriter::write_burst(const proto::Burst& burst, std::int64_t log_ns) {
  ENAMEL_TRY_ASSIGN(const proto::Bytes cdr, proto::to_cdr(burst));
  return write_burst_cdr(cdr, log_ns);
}

Result<void> CaptureWriter::write_burst_cdr(proto::ByteView cdr, std::int64_t log_ns) {
  ENAMEL_TRY_ASSIGN(const Stamp stamp, burst_stamp(cdr));
  return impl_->write(Kind::kBurst, cdr, log_ns, stamp);
}

Result<void> CaptureWriter::write_shed(const proto::ShedNote& note, std::int64_t log_ns) {
  return impl_->write_message(Kind::kShed, note, log_ns, static_cast<std::uint64_t>(note.t_host_ns));
}

Result<void> CaptureWriter::write_status(const proto::Status& status, std::int64_t log_ns) {
  return impl_->write_message(Kind::kStatus, status, log_ns, status.t_ns);
}

Result<void> CaptureWriter::write_event(const proto::Event& event, std::int64_t log_ns) {
  return impl_->write_message(Kind::kEvent, event, log_ns, event.t_ns);
}

Result<void> CaptureWriter::write_device_info(const proto::DeviceInfo& info, std::int64_t log_ns) {
  return impl_->write_message(Kind::kDeviceInfo, info, log_ns, 0);
}

Result<void> CaptureWriter::write_axes(const proto::AxesReading& reading, std::int64_t log_ns) {
  ENAMEL_TRY_ASSIGN(const proto::Bytes cdr, proto::to_cdr(reading));
  const auto k = static_cast<std::size_t>(Kind::kAxes);
  if (impl_->channels[k] == 0 && !impl_->out.failed()) ENAMEL_TRY(impl_->once(impl_->add_channel(Kind::kAxes)));
  return impl_->write(Kind::kAxes, cdr, log_ns, {impl_->sequences[k]++, 0});
}

Result<void> CaptureWriter::attach(const std::string& name, const std::string& media_type, proto::ByteView bytes) {
  auto& names = impl_->attachment_names;
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return fail(ErrorCode::kInternal, "attachment '" + name + "' written twice");
  }
  names.push_back(name);
  return impl_->once(impl_->out.write_attachment(name, media_type, std::as_bytes(bytes)));
}

Result<void> CaptureWriter::flush() { return impl_->once(impl_->out.flush()); }

Result<void> CaptureWriter::finish() {
  if (impl_->out.failed()) {
    return fail(ErrorCode::kFileWrite,
                "recording is incomplete: " + std::to_string(impl_->dropped) + " records were not written");
  }
  return impl_->out.close();
}

bool CaptureWriter::failed() const noexcept { return impl_->out.failed(); }
std::uint64_t CaptureWriter::dropped() const noexcept { return impl_->dropped; }

}  // namespace enamel::capture
