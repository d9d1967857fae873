#include "protocol/mcap/records.hpp"

namespace enamel::mcap {
namespace {

// Maps and arrays are preceded by their length in bytes.
template <class Body>
void put_sized(ByteWriter& out, Body&& body) {
  const std::size_t at = out.size();
  out.put(std::uint32_t{0});
  body();
  static_cast<void>(out.patch(at, static_cast<std::uint32_t>(out.size() - at - sizeof(std::uint32_t))));
}

std::map<std::uint16_t, std::uint64_t> take_counts(ByteReader& in) {
  std::map<std::uint16_t, std::uint64_t> out;
  ByteReader items(in.take(in.get<std::uint32_t>()));
  while (items.ok() && items.remaining() > 0) {
    const auto key = items.get<std::uint16_t>();
    const auto value = items.get<std::uint64_t>();
    if (items.ok()) out[key] = value;
  }
  if (!items.ok()) in.invalidate();
  return out;
}

KeyValues take_key_values(ByteReader& in) {
  KeyValues out;
  ByteReader items(in.take(in.get<std::uint32_t>()));
  while (items.ok() && items.remaining() > 0) {
    std::string key = take_string(items);
    std::string value = take_string(items);
    if (items.ok()) out.emplace_back(std::move(key), std::move(value));
  }
  if (!items.ok()) in.invalidate();
  return out;
}

template <class T>
std::optional<T> checked(const ByteReader& in, T value) {
  if (!in.ok()) return std::nullopt;
  return value;
}

}  // namespace

void put_string(ByteWriter& out, std::string_view text) {
  out.put(static_cast<std::uint32_t>(text.size()));
  out.put_text(text);
}

void put_record(ByteWriter& out, Op op, ByteSpan body) {
  out.put(static_cast<std::uint8_t>(op));
  out.put(std::uint64_t{body.size()});
  out.put_bytes(body);
}

void put_schema(ByteWriter& out, const Schema& schema) {
  ByteWriter body;
  body.put(schema.id);
  put_string(body, schema.name);
  put_string(body, schema.encoding);
  put_string(body, schema.data);
  put_record(out, Op::kSchema, body.bytes());
}

void put_channel(ByteWriter& out, const Channel& channel) {
  ByteWriter body;
  body.put(channel.id);
  body.put(channel.schema_id);
  put_string(body, channel.topic);
  put_string(body, channel.message_encoding);
  put_sized(body, [] {});
  put_record(out, Op::kChannel, body.bytes());
}

void put_chunk_index(ByteWriter& out, const ChunkIndex& index) {
  ByteWriter body;
  body.put(index.start_ns);
  body.put(index.end_ns);
  body.put(index.offset);
  body.put(index.length);
  put_sized(body, [&] {
    for (const auto& [channel, offset] : index.message_index_offsets) {
      body.put(channel);
      body.put(offset);
    }
  });
  body.put(index.message_index_length);
  put_string(body, index.compression);
  body.put(index.compressed_size);
  body.put(index.uncompressed_size);
  put_record(out, Op::kChunkIndex, body.bytes());
}

void put_attachment_index(ByteWriter& out, const AttachmentIndex& index) {
  ByteWriter body;
  body.put(index.offset);
  body.put(index.length);
  body.put(index.log_ns);
  body.put(index.create_ns);
  body.put(index.data_size);
  put_string(body, index.name);
  put_string(body, index.media_type);
  put_record(out, Op::kAttachmentIndex, body.bytes());
}

void put_metadata(ByteWriter& out, const Metadata& metadata) {
  ByteWriter body;
  put_string(body, metadata.name);
  put_sized(body, [&] {
    for (const auto& [key, value] : metadata.values) {
      put_string(body, key);
      put_string(body, value);
    }
  });
  put_record(out, Op::kMetadata, body.bytes());
}

void put_metadata_index(ByteWriter& out, const MetadataIndex& index) {
  ByteWriter body;
  body.put(index.offset);
  body.put(index.length);
  put_string(body, index.name);
  put_record(out, Op::kMetadataIndex, body.bytes());
}

std::optional<RecordHead> read_head(ByteSpan bytes) {
  ByteReader in(bytes);
  const auto op = in.get<std::uint8_t>();
  const auto length = in.get<std::uint64_t>();
  return checked(in, RecordHead{static_cast<Op>(op), length});
}

std::string take_string(ByteReader& in) {
  const auto n = in.get<std::uint32_t>();
  return std::string(in.take_text(n));
}

std::optional<Schema> read_schema(ByteSpan body) {
  ByteReader in(body);
  Schema s;
  s.id = in.get<std::uint16_t>();
  s.name = take_string(in);
  s.encoding = take_string(in);
  s.data = take_string(in);
  return checked(in, std::move(s));
}

std::optional<Channel> read_channel(ByteSpan body) {
  ByteReader in(body);
  Channel c;
  c.id = in.get<std::uint16_t>();
  c.schema_id = in.get<std::uint16_t>();
  c.topic = take_string(in);
  c.message_encoding = take_string(in);
  static_cast<void>(take_key_values(in));
  return checked(in, std::move(c));
}

std::optional<Metadata> read_metadata(ByteSpan body) {
  ByteReader in(body);
  Metadata m;
  m.name = take_string(in);
  m.values = take_key_values(in);
  return checked(in, std::move(m));
}

std::optional<Statistics> read_statistics(ByteSpan body) {
  ByteReader in(body);
  Statistics s;
  s.messages = in.get<std::uint64_t>();
  in.skip(sizeof(std::uint16_t) + 4 * sizeof(std::uint32_t));  // numbers of schemas, channels, attachments …
  s.start_ns = in.get<std::uint64_t>();
  s.end_ns = in.get<std::uint64_t>();
  s.per_channel = take_counts(in);
  return checked(in, std::move(s));
}

}  // namespace enamel::mcap
