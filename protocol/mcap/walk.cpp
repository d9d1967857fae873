// From the first record to the last of the data section.
#include <algorithm>

#include "protocol/mcap/reader_impl.hpp"

namespace enamel::mcap {
namespace {

constexpr std::uint64_t kLooseBlockBytes = std::uint64_t{4} << 20U;  // loose messages taken into memory together

// Appends a parsed record, or says that it was not readable.
template <class T>
bool keep(std::vector<T>& list, std::optional<T> item) {
  if (!item) return false;
  list.push_back(std::move(*item));
  return true;
}

bool of_the_summary(Op op) {
  return op == Op::kFooter || op == Op::kChunkIndex || op == Op::kAttachmentIndex || op == Op::kStatistics ||
         op == Op::kMetadataIndex || op == Op::kSummaryOffset;
}

std::size_t magic_bytes_right(ByteSpan bytes) {
  std::size_t right = 0;
  for (std::size_t i = 0; i < kMagic.size(); ++i) {
    if (bytes[i] == std::byte{kMagic[i]}) ++right;
  }
  return right;
}

}  // namespace

Result<std::uint64_t> Reader::Impl::read_header() {
  const auto foreign = [&](const char* what) { return fail(ErrorCode::kCaptureInvalid, source.path() + ": " + what); };
  if (source.size() == 0) return foreign("the file is empty");
  if (source.size() < kMagic.size() + kRecordHeader) return foreign("not an MCAP file, or cut in its first bytes");
  ENAMEL_TRY_ASSIGN(const auto begin, source.read(0, kMagic.size() + kRecordHeader));
  const std::size_t right = magic_bytes_right(begin);
  // A damaged magic has most of its bytes; one in eight is right by chance in every 32nd foreign file.
  if (right < kMagic.size() / 2) return foreign("not an MCAP file");
  if (right < kMagic.size()) problems.push_back("the first eight bytes are damaged");
  const auto head = read_head(ByteSpan(begin).subspan(kMagic.size()));
  ENAMEL_TRY_ASSIGN(const auto own, own_length(Op::kHeader, kMagic.size()));
  ENAMEL_TRY_ASSIGN(const auto length, body_length({Op::kHeader, head->length}, kMagic.size(), own));
  if (head->op != Op::kHeader || !length) {
    ENAMEL_TRY_ASSIGN(const auto next, find_record(kMagic.size()));
    if (!next) return foreign("the header is not whole");
    problems.push_back("the header is damaged");
    return *next;
  }
  ENAMEL_TRY_ASSIGN(const auto body, source.read(begin.size(), *length));
  ByteReader in{ByteSpan(body)};
  profile = take_string(in);
  library = take_string(in);
  return begin.size() + *length;
}

Result<void> Reader::Impl::walk(std::uint64_t at) {
  while (!ended_) {
    ENAMEL_TRY_ASSIGN(const bool taken, take_record(at));
    if (taken) continue;
    ENAMEL_TRY_ASSIGN(const auto next, find_record(at + 1));
    if (!next) {  // what is left is the record that its writer did not finish
      truncated = true;
      return {};
    }
    blocks.push_back({Block::Kind::kDamaged, at, *next - at, {}});
    at = *next;
  }
  return {};
}

Result<bool> Reader::Impl::take_record(std::uint64_t& at) {
  if (at > source.size() || source.size() - at < kRecordHeader) return false;
  ENAMEL_TRY_ASSIGN(const auto bytes, source.read(at, kRecordHeader));
  const RecordHead head = *read_head(bytes);
  constexpr std::uint64_t kDataEndBody = sizeof(std::uint32_t);
  if ((head.op == Op::kDataEnd && head.length == kDataEndBody) || of_the_summary(head.op)) {
    ENAMEL_TRY_ASSIGN(const bool sound, begins(at));
    if (sound) {
      ended_ = true;
      if (head.op == Op::kDataEnd) data_end = at;
      summary_at_ = head.op == Op::kDataEnd ? at + kRecordHeader + kDataEndBody : at;
      return true;
    }
  }
  using Length = std::optional<std::uint64_t>;
  ENAMEL_TRY_ASSIGN(const Length own, own_length(head.op, at));
  // A wrong opcode does not hide what is long: its fields say the same length as its head.
  for (const Op guess : {Op::kChunk, Op::kAttachment}) {
    if (own == head.length || guess == head.op) continue;
    ENAMEL_TRY_ASSIGN(const Length as_guessed, own_length(guess, at));
    if (as_guessed != head.length) continue;
    problems.push_back("opcode of the record at byte " + std::to_string(at) + " is damaged");
    at += kRecordHeader + head.length;
    return take_body(guess, at - kRecordHeader - head.length, head.length);
  }
  ENAMEL_TRY_ASSIGN(const Length length, body_length(head, at, own));
  if (!length) return false;
  ENAMEL_TRY_ASSIGN(const bool taken, take_body(head.op, at, *length));
  if (!taken) return false;
  if (*length != head.length) problems.push_back("length of the record at byte " + std::to_string(at) + " is damaged");
  at += kRecordHeader + *length;
  return true;
}

Result<bool> Reader::Impl::take_body(Op op, std::uint64_t at, std::uint64_t length) {
  switch (op) {
    case Op::kChunk:
      blocks.push_back({Block::Kind::kChunk, at, kRecordHeader + length, {}});
      return true;
    case Op::kMessage:
      take_loose(at, kRecordHeader + length);
      return true;
    case Op::kAttachment:
      return take_attachment(at, length);
    case Op::kSchema:
    case Op::kChannel:
    case Op::kMetadata:
    case Op::kMessageIndex:
      return take_small(op, at, length);
    default:
      return true;  // of a later version, or private
  }
}

void Reader::Impl::take_loose(std::uint64_t at, std::uint64_t length) {
  if (!blocks.empty()) {
    Block& last = blocks.back();
    if (last.kind == Block::Kind::kLoose && last.offset + last.length == at && last.length < kLooseBlockBytes) {
      last.length += length;
      return;
    }
  }
  blocks.push_back({Block::Kind::kLoose, at, length, {}});
}

Result<bool> Reader::Impl::take_small(Op op, std::uint64_t at, std::uint64_t length) {
  if (length > kMaxSmallRecord) return false;
  ENAMEL_TRY_ASSIGN(const auto record, source.read(at + kRecordHeader, length));
  const ByteSpan body(record);
  if (op == Op::kSchema) return keep(schemas, read_schema(body));
  if (op == Op::kChannel) return keep(channels, read_channel(body));
  if (op == Op::kMetadata) return keep(metadata, read_metadata(body));
  constexpr std::size_t kEntry = 2 * sizeof(std::uint64_t);
  ByteReader in(body);
  const auto channel = in.get<std::uint16_t>();
  const auto entries = in.get<std::uint32_t>() / kEntry;
  if (!in.ok()) return false;
  if (!blocks.empty() && entries > 0) blocks.back().told[channel] = entries;
  return true;
}

Result<bool> Reader::Impl::take_attachment(std::uint64_t at, std::uint64_t length) {
  constexpr std::uint64_t kHeadBytes = 4096;  // names and media types are short
  ENAMEL_TRY_ASSIGN(const auto begin, source.read(at + kRecordHeader, std::min(length, kHeadBytes)));
  ByteReader in{ByteSpan(begin)};
  AttachmentIndex index;
  index.offset = at;
  index.length = kRecordHeader + length;
  index.log_ns = in.get<std::uint64_t>();
  index.create_ns = in.get<std::uint64_t>();
  index.name = take_string(in);
  index.media_type = take_string(in);
  index.data_size = in.get<std::uint64_t>();
  if (!in.ok()) return false;
  attachments.push_back(std::move(index));
  return true;
}

}  // namespace enamel::mcap
