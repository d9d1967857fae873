// Bytes of the records. Private to this folder.
#pragma once

#include <optional>
#include <string_view>

#include "protocol/base/bytes.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

void put_string(ByteWriter& out, std::string_view text);
/// Opcode, length and body.
void put_record(ByteWriter& out, Op op, ByteSpan body);

void put_schema(ByteWriter& out, const Schema& schema);
void put_channel(ByteWriter& out, const Channel& channel);
void put_chunk_index(ByteWriter& out, const ChunkIndex& index);
void put_attachment_index(ByteWriter& out, const AttachmentIndex& index);
void put_metadata(ByteWriter& out, const Metadata& metadata);
void put_metadata_index(ByteWriter& out, const MetadataIndex& index);

struct RecordHead {
  Op op{};
  std::uint64_t length = 0;  ///< of the body
};
/// nullopt when fewer than kRecordHeader bytes are given.
[[nodiscard]] std::optional<RecordHead> read_head(ByteSpan bytes);

// Bodies. nullopt: cut short or a length out of range. Bytes behind the known fields are allowed by the specification.
[[nodiscard]] std::string take_string(ByteReader& in);
[[nodiscard]] std::optional<Schema> read_schema(ByteSpan body);
[[nodiscard]] std::optional<Channel> read_channel(ByteSpan body);
[[nodiscard]] std::optional<Metadata> read_metadata(ByteSpan body);
[[nodiscard]] std::optional<Statistics> read_statistics(ByteSpan body);

}  // namespace enamel::mcap
