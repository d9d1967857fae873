#include "protocol/mcap/reader.hpp"

#include <algorithm>
#include <array>

#include "protocol/base/bytes.hpp"
#include "protocol/capture/capture.hpp"
#include "protocol/capture/layout.hpp"

namespace enamel::capture {
namespace {

struct BurstPlace {
  std::uint64_t burst_index = 0;
  std::size_t chunk = 0, slot = 0;
};

proto::ByteView as_octets(mcap::ByteSpan bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

std::uint64_t burst_index_of(mcap::ByteSpan cdr) {
  ByteReader in(cdr);
  in.skip(4 + 4 + 4 + sizeof(std::uint64_t));  // encapsulation, probe_id, session_id, burst_seq
  return in.get<std::uint64_t>();
}

template <class T>
Result<Record> record_of(const mcap::Message& message) {
  ENAMEL_TRY_ASSIGN(T value, proto::from_cdr<T>(as_octets(message.data)));
  return Record{static_cast<std::int64_t>(message.header.log_ns), std::move(value)};
}

Result<Record> decode(Kind kind, const mcap::Message& message) {
  switch (kind) {
    case Kind::kBurst:
      return record_of<proto::Burst>(message);
    case Kind::kShed:
      return record_of<proto::ShedNote>(message);
    case Kind::kStatus:
      return record_of<proto::Status>(message);
    case Kind::kEvent:
      return record_of<proto::Event>(message);
    case Kind::kDeviceInfo:
      return record_of<proto::DeviceInfo>(message);
  }
  return fail(ErrorCode::kInternal, "unknown kind of record");
}

}  // namespace

struct CaptureReader::Impl {
  mcap::Reader in;
  std::string path;
  CaptureInfo info;
  std::string rig;
  std::map<std::uint16_t, Kind> kinds;
  // Position of next(): a chunk that is loaded and the slot in it.
  std::size_t next_chunk = 0, slot = 0;
  mcap::Chunk chunk;
  // Random access: table made on first use, last chunk kept.
  bool table_made = false;
  std::vector<BurstPlace> table;
  std::optional<Error> table_error;
  std::optional<std::size_t> cached;
  mcap::Chunk cache;

  Impl(mcap::Reader reader, std::string file) : in(std::move(reader)), path(std::move(file)) {}
  Result<void> fill_info();
  void count_by_reading();
  void count(Kind kind, std::uint64_t n);
  std::optional<Kind> kind_of(const mcap::Message& message) const;
  template <class Accept>
  Result<std::optional<Record>> advance(Accept&& accept);
  void make_table();
  Result<proto::Burst> burst_at(const BurstPlace& place);
  tl::unexpected<Error> not_found(const std::string& what) const;
};

std::optional<Kind> CaptureReader::Impl::kind_of(const mcap::Message& message) const {
  const auto it = kinds.find(message.header.channel_id);
  return it == kinds.end() ? std::nullopt : std::optional(it->second);
}

void CaptureReader::Impl::count(Kind kind, std::uint64_t n) {
  const std::array<std::uint64_t*, kKinds> counters{&info.bursts, &info.shed, &info.statuses, &info.events,
                                                    &info.device_infos};
  *counters[static_cast<std::size_t>(kind)] += n;
}

// Without a summary the messages of the readable chunks are counted one by one; next() reports the others.
void CaptureReader::Impl::count_by_reading() {
  bool first = true;
  for (std::size_t n = 0; n < in.chunks().size(); ++n) {
    const auto loaded = in.chunk(n);
    if (!loaded) continue;
    for (const mcap::Message& m : loaded->messages) {
      if (const auto kind = kind_of(m)) count(*kind, 1);
      const auto t = static_cast<std::int64_t>(m.header.log_ns);
      info.first_log_ns = first ? t : std::min(info.first_log_ns, t);
      info.last_log_ns = first ? t : std::max(info.last_log_ns, t);
      first = false;
    }
  }
}

Result<void> CaptureReader::Impl::fill_info() {
  for (const mcap::Channel& channel : in.channels()) {
    const auto schema = std::find_if(in.schemas().begin(), in.schemas().end(),
                                     [&](const mcap::Schema& s) { return s.id == channel.schema_id; });
    if (schema == in.schemas().end() || channel.message_encoding != kMessageEncoding) continue;
    for (std::size_t k = 0; k < kKinds; ++k) {
      if (channel.topic == kChannelNames[k].topic && schema->name == kChannelNames[k].schema) {
        kinds[channel.id] = static_cast<Kind>(k);
      }
    }
  }
  const bool has_bursts =
      std::any_of(kinds.begin(), kinds.end(), [](const auto& entry) { return entry.second == Kind::kBurst; });
  if (!has_bursts) return fail(ErrorCode::kCaptureInvalid, path + ": MCAP file without channel enamel/v1/burst");
  info.truncated = in.truncated();
  info.file_bytes = in.file_bytes();
  if (info.truncated && in.chunks().empty()) {
    return fail(ErrorCode::kCaptureInvalid, path + ": cut before its first whole chunk");
  }
  for (const mcap::Metadata& metadata : in.metadata()) {
    if (metadata.name != kMetadataName) continue;
    for (const auto& [key, value] : metadata.values) {
      if (key == kProgramKey) {
        info.program = value;
      } else {
        info.metadata.emplace_back(key, value);
      }
    }
  }
  for (const mcap::AttachmentIndex& a : in.attachments())
    info.attachments.push_back({a.name, a.media_type, a.data_size});
  if (const auto& statistics = in.statistics()) {
    for (const auto& [channel, n] : statistics->per_channel) {
      if (const auto it = kinds.find(channel); it != kinds.end()) count(it->second, n);
    }
    info.first_log_ns = static_cast<std::int64_t>(statistics->start_ns);
    info.last_log_ns = static_cast<std::int64_t>(statistics->end_ns);
  } else {
    count_by_reading();
  }
  return {};
}

template <class Accept>
Result<std::optional<Record>> CaptureReader::Impl::advance(Accept&& accept) {
  for (;;) {
    while (slot < chunk.messages.size()) {
      const mcap::Message& message = chunk.messages[slot++];
      const auto kind = kind_of(message);
      if (!kind || !accept(*kind)) continue;
      auto record = decode(*kind, message);
      if (!record) {
        return fail(record.error().code, path + ": record " + std::to_string(slot - 1) + " of chunk " +
                                             std::to_string(next_chunk - 1) + ": " + record.error().detail);
      }
      return std::optional<Record>(std::move(*record));
    }
    if (next_chunk >= in.chunks().size()) return std::optional<Record>{};
    chunk = mcap::Chunk{};
    slot = 0;
    auto loaded = in.chunk(next_chunk++);
    if (!loaded) return tl::unexpected<Error>(std::move(loaded).error());
    chunk = std::move(*loaded);
  }
}

void CaptureReader::Impl::make_table() {
  if (table_made) return;
  table_made = true;
  for (std::size_t n = 0; n < in.chunks().size(); ++n) {
    const auto loaded = in.chunk(n);
    if (!loaded) {
      if (!table_error) table_error = loaded.error();
      continue;
    }
    for (std::size_t s = 0; s < loaded->messages.size(); ++s) {
      const mcap::Message& m = loaded->messages[s];
      if (kind_of(m) == Kind::kBurst) table.push_back({burst_index_of(m.data), n, s});
    }
  }
}

Result<proto::Burst> CaptureReader::Impl::burst_at(const BurstPlace& place) {
  if (cached != place.chunk) {
    cached.reset();
    ENAMEL_TRY_ASSIGN(cache, in.chunk(place.chunk));
    cached = place.chunk;
  }
  return proto::from_cdr<proto::Burst>(as_octets(cache.messages[place.slot].data));
}

// A burst that is not found may have been in a chunk that could not be read.
tl::unexpected<Error> CaptureReader::Impl::not_found(const std::string& what) const {
  if (table_error) return fail(table_error->code, table_error->detail);
  return fail(ErrorCode::kBurstNotFound, path + ": " + what + "; it holds " + std::to_string(table.size()) + " bursts");
}

CaptureReader::CaptureReader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
CaptureReader::CaptureReader(CaptureReader&&) noexcept = default;
CaptureReader& CaptureReader::operator=(CaptureReader&&) noexcept = default;
CaptureReader::~CaptureReader() = default;

Result<CaptureReader> CaptureReader::open(const std::string& path) {
  ENAMEL_TRY_ASSIGN(mcap::Reader in, mcap::Reader::open(path));
  auto impl = std::make_unique<Impl>(std::move(in), path);
  ENAMEL_TRY(impl->fill_info());
  CaptureReader reader(std::move(impl));
  auto rig = reader.attachment(kRigAttachment);
  if (rig) {
    reader.impl_->rig.assign(rig->begin(), rig->end());
  } else if (rig.error().code != ErrorCode::kFileNotFound) {
    return tl::unexpected<Error>(std::move(rig).error());
  }
  return reader;
}

const CaptureInfo& CaptureReader::info() const noexcept { return impl_->info; }
const std::string& CaptureReader::rig_text() const noexcept { return impl_->rig; }

Result<proto::Bytes> CaptureReader::attachment(const std::string& name) {
  const auto& all = impl_->in.attachments();
  const auto it = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name == name; });
  if (it == all.end()) return fail(ErrorCode::kFileNotFound, impl_->path + ": no attachment '" + name + "'");
  ENAMEL_TRY_ASSIGN(const auto bytes, impl_->in.attachment(static_cast<std::size_t>(it - all.begin())));
  const proto::ByteView view = as_octets(bytes);
  return proto::Bytes(view.begin(), view.end());
}

Result<std::optional<Record>> CaptureReader::next() {
  return impl_->advance([](Kind) { return true; });
}

Result<std::optional<proto::Burst>> CaptureReader::next_burst() {
  ENAMEL_TRY_ASSIGN(auto record, impl_->advance([](Kind kind) { return kind == Kind::kBurst; }));
  if (!record) return std::optional<proto::Burst>{};
  return std::optional<proto::Burst>(std::get<proto::Burst>(std::move(record->value)));
}

void CaptureReader::rewind() noexcept {
  impl_->next_chunk = 0;
  impl_->slot = 0;
  impl_->chunk = mcap::Chunk{};
}

Result<proto::Burst> CaptureReader::burst(std::uint64_t ordinal) {
  impl_->make_table();
  if (ordinal >= impl_->table.size()) return impl_->not_found("no burst at position " + std::to_string(ordinal));
  return impl_->burst_at(impl_->table[ordinal]);
}

Result<proto::Burst> CaptureReader::burst_with_id(BurstId id) {
  impl_->make_table();
  const auto it = std::find_if(impl_->table.begin(), impl_->table.end(),
                               [&](const BurstPlace& place) { return place.burst_index == id.value; });
  if (it == impl_->table.end()) return impl_->not_found("no burst " + std::to_string(id.value));
  return impl_->burst_at(*it);
}

}  // namespace enamel::capture
