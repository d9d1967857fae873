#include "protocol/mcap/reader.hpp"

#include <algorithm>

#include "protocol/base/crc32.hpp"
#include "protocol/mcap/compression.hpp"
#include "protocol/mcap/reader_impl.hpp"

namespace enamel::mcap {
namespace {

// False: the records are not well-formed.
bool split_records(Chunk& chunk) {
  const ByteSpan records(chunk.records);
  ByteReader in(records);
  while (in.remaining() > 0) {
    const auto head = read_head(in.take(kRecordHeader));
    if (!head) return false;
    const ByteSpan body = in.take(head->length);
    if (!in.ok()) return false;
    if (head->op == Op::kSchema) {
      if (auto schema = read_schema(body)) chunk.schemas.push_back(std::move(*schema));
    }
    if (head->op == Op::kChannel) {
      if (auto channel = read_channel(body)) chunk.channels.push_back(std::move(*channel));
    }
    if (head->op != Op::kMessage) continue;
    ByteReader fields(body);
    Message m;
    m.header.channel_id = fields.get<std::uint16_t>();
    m.header.sequence = fields.get<std::uint32_t>();
    m.header.log_ns = fields.get<std::uint64_t>();
    m.header.publish_ns = fields.get<std::uint64_t>();
    m.data = fields.take(fields.remaining());
    if (!fields.ok()) return false;
    chunk.messages.push_back(m);
  }
  return true;
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
  ENAMEL_TRY(impl->walk(begin));
  ENAMEL_TRY(impl->read_summary());
  return Reader(std::move(impl));
}

bool Reader::truncated() const noexcept { return impl_->truncated; }
std::uint64_t Reader::file_bytes() const noexcept { return impl_->source.size(); }
const std::vector<std::string>& Reader::problems() const noexcept { return impl_->problems; }
const std::string& Reader::profile() const noexcept { return impl_->profile; }
const std::string& Reader::library() const noexcept { return impl_->library; }
const std::vector<Schema>& Reader::schemas() const noexcept { return impl_->schemas; }
const std::vector<Channel>& Reader::channels() const noexcept { return impl_->channels; }
const std::vector<Block>& Reader::blocks() const noexcept { return impl_->blocks; }
const std::vector<AttachmentIndex>& Reader::attachments() const noexcept { return impl_->attachments; }
const std::vector<Metadata>& Reader::metadata() const noexcept { return impl_->metadata; }
const std::optional<Statistics>& Reader::statistics() const noexcept { return impl_->statistics; }

Result<Chunk> Reader::read(std::size_t n) const {
  if (n >= impl_->blocks.size()) return fail(ErrorCode::kInternal, "no block " + std::to_string(n));
  const Block& block = impl_->blocks[n];
  const std::string where = impl_->source.path() + ": block " + std::to_string(n) + " of " +
                            std::to_string(impl_->blocks.size()) + " at byte " + std::to_string(block.offset);
  const auto corrupt = [&](const std::string& what) { return fail(ErrorCode::kCaptureCorrupt, where + ": " + what); };
  if (block.kind == Block::Kind::kDamaged) return corrupt(std::to_string(block.length) + " bytes are no record");
  if (block.length > kMaxChunkBytes) return corrupt("length out of range");
  ENAMEL_TRY_ASSIGN(auto bytes, impl_->source.read(block.offset, block.length));
  Chunk chunk;
  if (block.kind == Block::Kind::kLoose) {
    chunk.records = std::move(bytes);
  } else {
    const ByteSpan body = ByteSpan(bytes).subspan(kRecordHeader);
    const auto head = read_chunk_head(body);
    if (!head || head->compressed_size > body.size() - head->bytes || head->uncompressed_size > kMaxChunkBytes) {
      return corrupt("head is damaged");
    }
    auto plain =
        decompress(head->compression, body.subspan(head->bytes, head->compressed_size), head->uncompressed_size);
    if (!plain) return fail(plain.error().code, where + ": " + plain.error().detail);
    // 0: the writer did not compute it (permitted by the specification).
    if (head->crc != 0 && crc32(*plain) != head->crc) return corrupt("CRC differs");
    chunk.records = std::move(*plain);
  }
  if (!split_records(chunk)) return corrupt("records are malformed");
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
  const ByteSpan body = ByteSpan(record).subspan(kRecordHeader);
  ByteReader in(body);
  in.skip(2 * sizeof(std::uint64_t));
  const std::string name = take_string(in);
  static_cast<void>(take_string(in));
  const auto size = in.get<std::uint64_t>();
  const ByteSpan data = in.take(size);
  const std::size_t covered = in.position();
  const auto crc = in.get<std::uint32_t>();
  if (!in.ok() || name != index.name || size != index.data_size) return corrupt("head is damaged");
  if (crc != 0 && crc32(body.first(covered)) != crc) return corrupt("CRC differs");
  return std::vector<std::byte>(data.begin(), data.end());
}

Result<void> Reader::verify_data_section() const {
  if (!impl_->data_end) return {};
  const std::uint64_t end = *impl_->data_end;
  ENAMEL_TRY_ASSIGN(const auto record, impl_->source.read(end, kRecordHeader + sizeof(std::uint32_t)));
  const auto stored = ByteReader{ByteSpan(record).subspan(kRecordHeader)}.get<std::uint32_t>();
  if (stored == 0) return {};  // the writer did not compute it (permitted by the specification)
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 20U;
  std::uint32_t crc = 0;
  for (std::uint64_t at = 0; at < end; at += kPiece) {
    ENAMEL_TRY_ASSIGN(const auto piece, impl_->source.read(at, std::min(kPiece, end - at)));
    crc = crc32(piece, crc);
  }
  if (stored != crc) {
    return fail(ErrorCode::kCaptureCorrupt, impl_->source.path() + ": data section CRC differs");
  }
  return {};
}

}  // namespace enamel::mcap
