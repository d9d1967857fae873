#include "protocol/mcap/writer.hpp"

#include <algorithm>

#include "protocol/base/crc32.hpp"
#include "protocol/mcap/compression.hpp"
#include "protocol/mcap/file_sink.hpp"
#include "protocol/mcap/records.hpp"

namespace enamel::mcap {
namespace {

struct IndexEntry {
  std::uint64_t log_ns = 0;
  std::uint64_t offset = 0;
};

ByteSpan as_span(const std::vector<std::byte>& bytes) { return bytes; }

}  // namespace

struct Writer::Impl {
  WriterOptions options;
  FileSink sink;
  bool has_failed = false;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<ChunkIndex> chunks;
  std::vector<AttachmentIndex> attachments;
  std::vector<MetadataIndex> metadatas;
  Statistics statistics;
  ByteWriter chunk;
  std::map<std::uint16_t, std::vector<IndexEntry>> chunk_entries;
  std::uint64_t chunk_start_ns = 0, chunk_end_ns = 0;

  Result<void> append(ByteSpan bytes);
  Result<void> write_chunk();
  Result<void> write_summary();
  void put_chunk_record(ByteWriter& out, ByteSpan records, std::string_view compression) const;
  void put_message_indexes(ByteWriter& out, ChunkIndex& index) const;
  void put_statistics(ByteWriter& out) const;
};

Result<void> Writer::Impl::append(ByteSpan bytes) {
  if (has_failed) return fail(ErrorCode::kFileWrite, "an earlier write failed");
  auto written = sink.append(bytes);
  if (!written) {
    has_failed = true;
    sink.close_quietly();
  }
  return written;
}

void Writer::Impl::put_chunk_record(ByteWriter& out, ByteSpan records, std::string_view compression) const {
  const std::uint64_t body = 3 * sizeof(std::uint64_t) + 2 * sizeof(std::uint32_t) + compression.size() +
                             sizeof(std::uint64_t) + records.size();
  out.put(static_cast<std::uint8_t>(Op::kChunk));
  out.put(body);
  out.put(chunk_start_ns);
  out.put(chunk_end_ns);
  out.put(std::uint64_t{chunk.size()});
  out.put(crc32(chunk.bytes()));
  put_string(out, compression);
  out.put(std::uint64_t{records.size()});
  out.put_bytes(records);
}

// `out` begins with the chunk record, which lies at index.offset in the file.
void Writer::Impl::put_message_indexes(ByteWriter& out, ChunkIndex& index) const {
  for (const auto& [channel, entries] : chunk_entries) {
    index.message_index_offsets[channel] = index.offset + out.size();
    ByteWriter body;
    body.put(channel);
    body.put(static_cast<std::uint32_t>(entries.size() * sizeof(IndexEntry)));
    for (const IndexEntry& entry : entries) {
      body.put(entry.log_ns);
      body.put(entry.offset);
    }
    put_record(out, Op::kMessageIndex, body.bytes());
  }
}

Result<void> Writer::Impl::write_chunk() {
  if (chunk.size() == 0) return {};
  std::vector<std::byte> compressed;
  if (options.compress) {
    ENAMEL_TRY_ASSIGN(compressed, compress(chunk.bytes()));
  }
  ChunkIndex index;
  index.start_ns = chunk_start_ns;
  index.end_ns = chunk_end_ns;
  index.offset = sink.position();
  index.compression = options.compress ? kZstd : "";
  index.uncompressed_size = chunk.size();
  const ByteSpan records = options.compress ? as_span(compressed) : chunk.bytes();
  index.compressed_size = records.size();
  ByteWriter out;
  put_chunk_record(out, records, index.compression);
  index.length = out.size();
  put_message_indexes(out, index);
  index.message_index_length = out.size() - index.length;
  ENAMEL_TRY(append(out.bytes()));
  for (const auto& [channel, entries] : chunk_entries) {
    statistics.per_channel[channel] += entries.size();
    statistics.messages += entries.size();
  }
  statistics.start_ns = chunks.empty() ? chunk_start_ns : std::min(statistics.start_ns, chunk_start_ns);
  statistics.end_ns = std::max(statistics.end_ns, chunk_end_ns);
  chunks.push_back(std::move(index));
  chunk.clear();
  chunk_entries.clear();
  return {};
}

void Writer::Impl::put_statistics(ByteWriter& out) const {
  ByteWriter body;
  body.put(statistics.messages);
  body.put(static_cast<std::uint16_t>(schemas.size()));
  body.put(static_cast<std::uint32_t>(channels.size()));
  body.put(static_cast<std::uint32_t>(attachments.size()));
  body.put(static_cast<std::uint32_t>(metadatas.size()));
  body.put(static_cast<std::uint32_t>(chunks.size()));
  body.put(statistics.start_ns);
  body.put(statistics.end_ns);
  body.put(static_cast<std::uint32_t>(statistics.per_channel.size() * (sizeof(std::uint16_t) + sizeof(std::uint64_t))));
  for (const auto& [channel, count] : statistics.per_channel) {
    body.put(channel);
    body.put(count);
  }
  put_record(out, Op::kStatistics, body.bytes());
}

Result<void> Writer::Impl::write_summary() {
  ByteWriter end;
  end.put(sink.crc());
  ByteWriter out;
  put_record(out, Op::kDataEnd, end.bytes());
  const std::size_t data_end = out.size();
  const std::uint64_t base = sink.position();
  ByteWriter offsets;
  const auto group = [&](Op op, const auto& items, auto put) {
    const std::size_t start = out.size();
    for (const auto& item : items) put(out, item);
    if (out.size() == start) return;
    ByteWriter body;
    body.put(static_cast<std::uint8_t>(op));
    body.put(std::uint64_t{base + start});
    body.put(std::uint64_t{out.size() - start});
    put_record(offsets, Op::kSummaryOffset, body.bytes());
  };
  group(Op::kSchema, schemas, put_schema);
  group(Op::kChannel, channels, put_channel);
  group(Op::kStatistics, std::array{this}, [](ByteWriter& w, const Impl* self) { self->put_statistics(w); });
  group(Op::kChunkIndex, chunks, put_chunk_index);
  group(Op::kAttachmentIndex, attachments, put_attachment_index);
  group(Op::kMetadataIndex, metadatas, put_metadata_index);
  const std::uint64_t offsets_start = base + out.size();
  out.put_bytes(offsets.bytes());
  out.put(static_cast<std::uint8_t>(Op::kFooter));
  out.put(std::uint64_t{kFooterRecord - kRecordHeader});
  out.put(std::uint64_t{base + data_end});
  out.put(offsets_start);
  out.put(crc32(out.bytes().subspan(data_end)));
  out.put_bytes(std::as_bytes(std::span(kMagic)));
  return append(out.bytes());
}

Writer::Writer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;

Writer::~Writer() {
  if (impl_ && impl_->sink.is_open()) static_cast<void>(impl_->write_chunk());
}

Result<Writer> Writer::create(const std::string& path, const WriterOptions& options) {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  ENAMEL_TRY(impl->sink.open(path));
  ByteWriter body;
  put_string(body, options.profile);
  put_string(body, options.library);
  ByteWriter out;
  out.put_bytes(std::as_bytes(std::span(kMagic)));
  put_record(out, Op::kHeader, body.bytes());
  ENAMEL_TRY(impl->append(out.bytes()));
  return Writer(std::move(impl));
}

Result<std::uint16_t> Writer::add_schema(std::string_view name, std::string_view encoding, std::string_view data) {
  const auto id = static_cast<std::uint16_t>(impl_->schemas.size() + 1);
  Schema schema{id, std::string(name), std::string(encoding), std::string(data)};
  ByteWriter out;
  put_schema(out, schema);
  ENAMEL_TRY(impl_->append(out.bytes()));
  impl_->schemas.push_back(std::move(schema));
  return id;
}

Result<std::uint16_t> Writer::add_channel(std::uint16_t schema_id, std::string_view topic,
                                          std::string_view message_encoding) {
  const auto id = static_cast<std::uint16_t>(impl_->channels.size() + 1);
  Channel channel{id, schema_id, std::string(topic), std::string(message_encoding)};
  ByteWriter out;
  put_channel(out, channel);
  ENAMEL_TRY(impl_->append(out.bytes()));
  impl_->channels.push_back(std::move(channel));
  return id;
}

Result<void> Writer::write_message(const MessageHeader& header, ByteSpan data) {
  if (impl_->has_failed) return fail(ErrorCode::kFileWrite, "an earlier write failed");
  ByteWriter& out = impl_->chunk;
  const bool first = out.size() == 0;
  impl_->chunk_start_ns = first ? header.log_ns : std::min(impl_->chunk_start_ns, header.log_ns);
  impl_->chunk_end_ns = first ? header.log_ns : std::max(impl_->chunk_end_ns, header.log_ns);
  impl_->chunk_entries[header.channel_id].push_back({header.log_ns, out.size()});
  out.put(static_cast<std::uint8_t>(Op::kMessage));
  out.put(std::uint64_t{sizeof header.channel_id + sizeof header.sequence + 2 * sizeof header.log_ns + data.size()});
  out.put(header.channel_id);
  out.put(header.sequence);
  out.put(header.log_ns);
  out.put(header.publish_ns);
  out.put_bytes(data);
  return out.size() >= impl_->options.chunk_bytes ? impl_->write_chunk() : Result<void>{};
}

Result<void> Writer::write_attachment(std::string_view name, std::string_view media_type, ByteSpan data) {
  AttachmentIndex index;
  index.offset = impl_->sink.position();
  index.data_size = data.size();
  index.name = name;
  index.media_type = media_type;
  ByteWriter body;
  body.put(index.log_ns);
  body.put(index.create_ns);
  put_string(body, name);
  put_string(body, media_type);
  body.put(std::uint64_t{data.size()});
  body.put_bytes(data);
  body.put(crc32(body.bytes()));
  ByteWriter out;
  put_record(out, Op::kAttachment, body.bytes());
  index.length = out.size();
  ENAMEL_TRY(impl_->append(out.bytes()));
  impl_->attachments.push_back(std::move(index));
  return {};
}

Result<void> Writer::write_metadata(const Metadata& metadata) {
  ByteWriter out;
  put_metadata(out, metadata);
  const std::uint64_t offset = impl_->sink.position();
  ENAMEL_TRY(impl_->append(out.bytes()));
  impl_->metadatas.push_back({offset, out.size(), metadata.name});
  return {};
}

Result<void> Writer::flush() { return impl_->write_chunk(); }

Result<void> Writer::close() {
  ENAMEL_TRY(impl_->write_chunk());
  ENAMEL_TRY(impl_->write_summary());
  auto closed = impl_->sink.sync_and_close();
  if (!closed) impl_->has_failed = true;
  return closed;
}

bool Writer::failed() const noexcept { return impl_->has_failed; }

}  // namespace enamel::mcap
