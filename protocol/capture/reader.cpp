// Records one by one, and bursts by position and number.
#include <algorithm>

#include "protocol/base/bytes.hpp"
#include "protocol/capture/reader_impl.hpp"

namespace enamel::capture {
namespace {

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
    case Kind::kAxes:
      return record_of<proto::AxesReading>(message);
  }
  return fail(ErrorCode::kInternal, "unknown kind of record");
}

}  // namespace

std::optional<Kind> CaptureReader::Impl::kind_of(const mcap::Message& message) const {
  const auto it = kinds.find(message.header.channel_id);
  return it == kinds.end() ? std::nullopt : std::optional(it->second);
}

template <class Accept>
Result<std::optional<Record>> CaptureReader::Impl::advance(Accept&& accept) {
  for (;;) {
    while (slot < chunk.messages.size()) {
      const mcap::Message& message = chunk.messages[slot++];
      const auto kind = kind_of(message);
      if (!kind) continue;
      if (*kind == Kind::kBurst) ++seen;
      if (!accept(*kind)) continue;
      auto record = decode(*kind, message);
      if (!record) {
        if (*kind == Kind::kBurst) ++lost;
        return fail(record.error().code, path + ": record " + std::to_string(slot - 1) + " of block " +
                                             std::to_string(next_block - 1) + ": " + record.error().detail);
      }
      return std::optional<Record>(std::move(*record));
    }
    chunk = mcap::Chunk{};
    slot = 0;
    if (next_block >= in.blocks().size()) return at_end();
    auto loaded = in.read(next_block++);
    if (!loaded) {
      const std::uint64_t gone = bursts_in(in.blocks()[next_block - 1]);
      seen += gone;
      lost += gone;
      return tl::unexpected<Error>(std::move(loaded).error());
    }
    chunk = std::move(*loaded);
    learn(chunk.channels, chunk.schemas);
  }
}

Result<std::optional<Record>> CaptureReader::Impl::at_end() {
  if (!in.statistics() || seen >= info.bursts) return std::optional<Record>{};
  const std::uint64_t missing = info.bursts - seen;
  seen += missing;
  lost += missing;
  return fail(ErrorCode::kCaptureCorrupt, path + ": the summary counts " + std::to_string(info.bursts) + " bursts; " +
                                              std::to_string(missing) + " of them are in no whole chunk");
}

void CaptureReader::Impl::make_table() {
  if (table_made) return;
  table_made = true;
  for (std::size_t n = 0; n < in.blocks().size(); ++n) {
    const auto loaded = in.read(n);
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
    ENAMEL_TRY_ASSIGN(cache, in.read(place.chunk));
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
  } else {
    reader.impl_->seek_rig(rig.error());
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

std::uint64_t CaptureReader::bursts_lost() const noexcept { return impl_->lost; }

void CaptureReader::rewind() noexcept {
  impl_->next_block = 0;
  impl_->slot = 0;
  impl_->seen = impl_->lost = 0;
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
