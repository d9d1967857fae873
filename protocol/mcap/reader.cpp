#include "protocol/mcap/reader.hpp"

#include <algorithm>

#include "protocol/base/crc32.hpp"
#include "protocol/mcap/compression.hpp"
#include "protocol/mcap/reader_impl.hpp"
#include "protocol/mcap/records.hpp"

namespace enamel::mcap {
namespace {

// nullopt: the records are not well-formed although their CRC is right.
std::optional<std::vector<Message>> split_messages(ByteSpan records) {
  std::vector<Message> out;
  ByteReader in(records);
  while (in.remaining() > 0) {
    const auto head = read_head(in.take(kRecordHeader));
    if (!head) return std::nullopt;
    const ByteSpan body = in.take(head->length);
    if (!in.ok()) return std::nullopt;
    if (head->op != Op::kMessage) continue;
    ByteReader fields(body);
    Message m;
    m.header.channel_id = fields.get<std::uint16_t>();
    m.header.sequence = fields.get<std::uint32_t>();
    m.header.log_ns = fields.get<std::uint64_t>();
    m.header.publish_ns = fields.get<std::uint64_t>();
    m.data = fields.take(fields.remaining());
    if (!fields.ok()) return std::nullopt;
    out.push_back(m);
  }
  return out;
}

bool matches(const ChunkHead& head, const ChunkIndex& index) {
  return head.start_ns == index.start_ns && head.end_ns == index.end_ns && head.compression == index.compression &&
         head.compressed_size == index.compressed_size && head.uncompressed_size == index.uncompressed_size;
}

}  // namespace

std::optional<ChunkHead> read_chunk_head(ByteSpan body) {
  ByteReader in(body);
  ChunkHead h;
  h.start_ns = in.get<std::uint64_t>();
  h.end_ns = in.get<std::uint64_t>();
  h.uncompressed_size = in.get<std::uint64_t>();
  h.crc = in.get<std::uint32_t>();
  h.compression = take_string(in);
  h.compressed_size = in.get<std::uint64_t>();
  h.bytes = in.position();
  if (!in.ok()) return std::nullopt;
  return h;
}

Reader::Reader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

Result<Reader> Reader::open(const std::string& path) {
  auto impl = std::make_unique<Impl>();
  ENAMEL_TRY(impl->source.open(path));
  ENAMEL_TRY_ASSIGN(const std::uint64_t begin, impl->read_header());
  ENAMEL_TRY_ASSIGN(const bool whole, impl->has_end());
  ENAMEL_TRY(whole ? impl->read_summary() : impl->scan(begin));
  return Reader(std::move(impl));
}

bool Reader::truncated() const noexcept { return impl_->truncated; }
std::uint64_t Reader::file_bytes() const noexcept { return impl_->source.size(); }
const std::string& Reader::library() const noexcept { return impl_->library; }
const std::vector<Schema>& Reader::schemas() const noexcept { return impl_->schemas; }
const std::vector<Channel>& Reader::channels() const noexcept { return impl_->channels; }
const std::vector<ChunkIndex>& Reader::chunks() const noexcept { return impl_->chunks; }
const std::vector<AttachmentIndex>& Reader::attachments() const noexcept { return impl_->attachments; }
const std::vector<Metadata>& Reader::metadata() const noexcept { return impl_->metadata; }
const std::optional<Statistics>& Reader::statistics() const noexcept { return impl_->statistics; }

Result<Chunk> Reader::chunk(std::size_t n) const {
  if (n >= impl_->chunks.size()) return fail(ErrorCode::kInternal, "no chunk " + std::to_string(n));
  const ChunkIndex& index = impl_->chunks[n];
  const std::string where = impl_->source.path() + ": chunk " + std::to_string(n) + " of " +
                            std::to_string(impl_->chunks.size()) + " at byte " + std::to_string(index.offset);
  const auto corrupt = [&](const char* what) { return fail(ErrorCode::kCaptureCorrupt, where + ": " + what); };
  if (index.length < kRecordHeader || index.length > kMaxChunkBytes) return corrupt("length out of range");
  ENAMEL_TRY_ASSIGN(const auto record, impl_->source.read(index.offset, index.length));
  const auto record_head = read_head(record);
  const ByteSpan body = ByteSpan(record).subspan(kRecordHeader);
  const auto head = read_chunk_head(body);
  if (record_head->op != Op::kChunk || record_head->length != body.size() || !head || !matches(*head, index) ||
      head->compressed_size != body.size() - head->bytes || head->uncompressed_size > kMaxChunkBytes) {
    return corrupt("head is damaged");
  }
  const ByteSpan stored = body.subspan(head->bytes);
  Chunk chunk;
  if (head->compression.empty()) {
    if (head->uncompressed_size != stored.size()) return corrupt("head is damaged");
    chunk.records.assign(stored.begin(), stored.end());
  } else if (head->compression == kZstd) {
    auto plain = decompress(stored, head->uncompressed_size);
    if (!plain) return corrupt(plain.error().detail.c_str());
    chunk.records = std::move(*plain);
  } else {
    return fail(ErrorCode::kCaptureInvalid, where + ": compression '" + head->compression + "' is not read here");
  }
  if (crc32(chunk.records) != head->crc) return corrupt("CRC differs");
  auto messages = split_messages(chunk.records);
  if (!messages) return corrupt("records are malformed");
  chunk.messages = std::move(*messages);
  return chunk;
}

Result<std::vector<std::byte>> Reader::attachment(std::size_t n) const {
  if (n >= impl_->attachments.size()) return fail(ErrorCode::kInternal, "no attachment " + std::to_string(n));
  const AttachmentIndex& index = impl_->attachments[n];
  const auto corrupt = [&](const char* what) {
    return fail(ErrorCode::kCaptureCorrupt, impl_->source.path() + ": attachment '" + index.name + "': " + what);
  };
  if (index.length < kRecordHeader || index.data_size > kMaxAttachmentBytes ||
      index.length > kMaxAttachmentBytes + kMaxAttachmentBytes) {
    return corrupt("length out of range");
  }
  ENAMEL_TRY_ASSIGN(const auto record, impl_->source.read(index.offset, index.length));
  const auto head = read_head(record);
  const ByteSpan body = ByteSpan(record).subspan(kRecordHeader);
  if (head->op != Op::kAttachment || head->length != body.size()) return corrupt("head is damaged");
  ByteReader in(body);
  in.skip(2 * sizeof(std::uint64_t));
  const std::string name = take_string(in);
  static_cast<void>(take_string(in));
  const auto size = in.get<std::uint64_t>();
  const ByteSpan data = in.take(size);
  const std::size_t covered = in.position();
  const auto crc = in.get<std::uint32_t>();
  if (!in.ok() || name != index.name || size != index.data_size) return corrupt("head is damaged");
  if (crc32(body.first(covered)) != crc) return corrupt("CRC differs");
  return std::vector<std::byte>(data.begin(), data.end());
}

Result<void> Reader::verify_data_section() const {
  if (impl_->truncated) return {};
  constexpr std::uint64_t kBlock = std::uint64_t{1} << 20U;
  std::uint32_t crc = 0;
  for (std::uint64_t at = 0; at < impl_->data_end; at += kBlock) {
    ENAMEL_TRY_ASSIGN(const auto block, impl_->source.read(at, std::min(kBlock, impl_->data_end - at)));
    crc = crc32(block, crc);
  }
  ENAMEL_TRY_ASSIGN(const auto record, impl_->source.read(impl_->data_end, kRecordHeader + sizeof crc));
  ByteReader in{ByteSpan(record)};
  const auto op = in.get<std::uint8_t>();
  const auto length = in.get<std::uint64_t>();
  const auto stored = in.get<std::uint32_t>();
  if (op != static_cast<std::uint8_t>(Op::kDataEnd) || length != sizeof crc) {
    return fail(ErrorCode::kCaptureCorrupt, impl_->source.path() + ": end of data is damaged");
  }
  // 0: the writer did not compute it (permitted by the specification).
  if (stored != 0 && stored != crc) {
    return fail(ErrorCode::kCaptureCorrupt, impl_->source.path() + ": data section CRC differs");
  }
  return {};
}

}  // namespace enamel::mcap
