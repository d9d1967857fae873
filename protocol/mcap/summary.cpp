// Opening: by the summary of a whole file, or record by record when the end is missing.
#include <algorithm>

#include "protocol/base/crc32.hpp"
#include "protocol/mcap/reader_impl.hpp"
#include "protocol/mcap/records.hpp"

namespace enamel::mcap {
namespace {

bool is_magic(ByteSpan bytes) {
  const auto magic = std::as_bytes(std::span(kMagic));
  return std::equal(bytes.begin(), bytes.end(), magic.begin(), magic.end());
}

// Appends a parsed record, or says that it was not readable.
template <class T>
bool keep(std::vector<T>& list, std::optional<T> item) {
  if (!item) return false;
  list.push_back(std::move(*item));
  return true;
}

constexpr std::uint64_t kMaxSmallRecord = std::uint64_t{16} << 20U;  // any record but chunks and attachments

}  // namespace

Result<std::uint64_t> Reader::Impl::read_header() {
  const auto foreign = [&](const char* what) { return fail(ErrorCode::kCaptureInvalid, source.path() + ": " + what); };
  if (source.size() == 0) return foreign("the file is empty");
  if (source.size() < kMagic.size() + kRecordHeader) return foreign("not an MCAP file, or cut in its first bytes");
  ENAMEL_TRY_ASSIGN(const auto begin, source.read(0, kMagic.size() + kRecordHeader));
  if (!is_magic(ByteSpan(begin).first(kMagic.size()))) return foreign("not an MCAP file");
  const auto head = read_head(ByteSpan(begin).subspan(kMagic.size()));
  if (!head || head->op != Op::kHeader || head->length > kMaxSmallRecord ||
      head->length > source.size() - begin.size()) {
    return foreign("the header is not whole");
  }
  ENAMEL_TRY_ASSIGN(const auto body, source.read(begin.size(), head->length));
  ByteReader in{ByteSpan(body)};
  static_cast<void>(take_string(in));
  library = take_string(in);
  if (!in.ok()) return foreign("the header is not whole");
  return begin.size() + head->length;
}

Result<bool> Reader::Impl::has_end() const {
  if (source.size() < 2 * kMagic.size() + kFooterRecord) return false;
  ENAMEL_TRY_ASSIGN(const auto end, source.read(source.size() - kMagic.size(), kMagic.size()));
  return is_magic(end);
}

Result<void> Reader::Impl::read_summary() {
  const std::uint64_t footer_at = source.size() - kMagic.size() - kFooterRecord;
  ENAMEL_TRY_ASSIGN(const auto footer, source.read(footer_at, kFooterRecord));
  ByteReader in{ByteSpan(footer)};
  const auto op = in.get<std::uint8_t>();
  const auto length = in.get<std::uint64_t>();
  const auto summary_start = in.get<std::uint64_t>();
  const auto offsets_start = in.get<std::uint64_t>();
  const auto crc = in.get<std::uint32_t>();
  constexpr std::uint64_t kDataEndRecord = kRecordHeader + sizeof(std::uint32_t);
  if (op != static_cast<std::uint8_t>(Op::kFooter) || length != kFooterRecord - kRecordHeader ||
      summary_start < kMagic.size() + kDataEndRecord || summary_start > offsets_start || offsets_start > footer_at) {
    return corrupt("footer is damaged");
  }
  ENAMEL_TRY_ASSIGN(const auto summary, source.read(summary_start, footer_at - summary_start));
  const ByteSpan footer_fields = ByteSpan(footer).first(kFooterRecord - sizeof crc);
  if (crc32(footer_fields, crc32(summary)) != crc) return corrupt("summary is damaged (CRC)");
  data_end = summary_start - kDataEndRecord;
  ByteReader records{ByteSpan(summary)};
  while (records.remaining() > 0) {
    const auto head = read_head(records.take(kRecordHeader));
    if (!head) return corrupt("summary is damaged");
    const ByteSpan body = records.take(head->length);
    if (!records.ok()) return corrupt("summary is damaged");
    ENAMEL_TRY(take_summary_record(head->op, body));
  }
  return {};
}

Result<void> Reader::Impl::take_summary_record(Op op, ByteSpan body) {
  bool good = true;
  switch (op) {
    case Op::kSchema:
      good = keep(schemas, read_schema(body));
      break;
    case Op::kChannel:
      good = keep(channels, read_channel(body));
      break;
    case Op::kChunkIndex:
      good = keep(chunks, read_chunk_index(body));
      break;
    case Op::kAttachmentIndex:
      good = keep(attachments, read_attachment_index(body));
      break;
    case Op::kStatistics:
      good = (statistics = read_statistics(body)).has_value();
      break;
    case Op::kMetadataIndex: {
      const auto index = read_metadata_index(body);
      if (index) return read_metadata_at(*index);
      good = false;
      break;
    }
    default:
      break;
  }
  return good ? Result<void>{} : corrupt("summary is damaged");
}

Result<void> Reader::Impl::read_metadata_at(const MetadataIndex& index) {
  if (index.length < kRecordHeader || index.length > kMaxSmallRecord) return corrupt("metadata index is damaged");
  ENAMEL_TRY_ASSIGN(const auto record, source.read(index.offset, index.length));
  const auto head = read_head(record);
  if (head->op != Op::kMetadata || head->length != index.length - kRecordHeader ||
      !keep(metadata, read_metadata(ByteSpan(record).subspan(kRecordHeader))) || metadata.back().name != index.name) {
    return corrupt("metadata '" + index.name + "' is damaged");
  }
  return {};
}

Result<void> Reader::Impl::scan(std::uint64_t offset) {
  truncated = true;
  while (source.size() - offset >= kRecordHeader) {
    ENAMEL_TRY_ASSIGN(const auto bytes, source.read(offset, kRecordHeader));
    const RecordHead head = *read_head(bytes);
    if (head.length > source.size() - offset - kRecordHeader) break;
    // DataEnd: the rest is summary. Zero: blocks that were reserved and never written.
    if (head.op == Op::kDataEnd || static_cast<std::uint8_t>(head.op) == 0) break;
    if (auto taken = take_scanned_record(head.op, offset, kRecordHeader + head.length); !taken) {
      if (taken.error().code != ErrorCode::kCaptureCorrupt) return taken;
      break;
    }
    offset += kRecordHeader + head.length;
  }
  data_end = offset;
  return {};
}

Result<void> Reader::Impl::take_scanned_record(Op op, std::uint64_t offset, std::uint64_t length) {
  if (op == Op::kChunk) return take_scanned_chunk(offset, length);
  if (op == Op::kAttachment) return take_scanned_attachment(offset, length);
  if (op != Op::kSchema && op != Op::kChannel && op != Op::kMetadata) return {};
  if (length > kMaxSmallRecord) return corrupt("record is too long");
  ENAMEL_TRY_ASSIGN(const auto record, source.read(offset, length));
  const ByteSpan body = ByteSpan(record).subspan(kRecordHeader);
  const bool good = op == Op::kSchema    ? keep(schemas, read_schema(body))
                    : op == Op::kChannel ? keep(channels, read_channel(body))
                                         : keep(metadata, read_metadata(body));
  return good ? Result<void>{} : corrupt("record is damaged");
}

Result<void> Reader::Impl::take_scanned_chunk(std::uint64_t offset, std::uint64_t length) {
  constexpr std::uint64_t kHeadBytes = 64;
  ENAMEL_TRY_ASSIGN(const auto begin, source.read(offset, std::min(length, kRecordHeader + kHeadBytes)));
  const auto head = read_chunk_head(ByteSpan(begin).subspan(kRecordHeader));
  if (!head) return corrupt("chunk head is damaged");
  ChunkIndex index;
  index.start_ns = head->start_ns;
  index.end_ns = head->end_ns;
  index.offset = offset;
  index.length = length;
  index.compression = head->compression;
  index.compressed_size = head->compressed_size;
  index.uncompressed_size = head->uncompressed_size;
  chunks.push_back(std::move(index));
  return {};
}

Result<void> Reader::Impl::take_scanned_attachment(std::uint64_t offset, std::uint64_t length) {
  constexpr std::uint64_t kHeadBytes = 4096;  // names and media types are short
  ENAMEL_TRY_ASSIGN(const auto begin, source.read(offset, std::min(length, kRecordHeader + kHeadBytes)));
  ByteReader in{ByteSpan(begin).subspan(kRecordHeader)};
  AttachmentIndex index;
  index.offset = offset;
  index.length = length;
  index.log_ns = in.get<std::uint64_t>();
  index.create_ns = in.get<std::uint64_t>();
  index.name = take_string(in);
  index.media_type = take_string(in);
  index.data_size = in.get<std::uint64_t>();
  if (!in.ok()) return corrupt("attachment head is damaged");
  attachments.push_back(std::move(index));
  return {};
}

}  // namespace enamel::mcap
