// Whether a record begins at a place of the file: by what its fields say of its length, which its head says too.
#include <algorithm>
#include <array>

#include "protocol/mcap/compression.hpp"
#include "protocol/mcap/reader_impl.hpp"

namespace enamel::mcap {
namespace {

constexpr std::size_t kTexts = 3;  // of a schema
constexpr std::uint64_t kIndexEntry = 2 * sizeof(std::uint64_t);
constexpr std::uint64_t kStatisticsHead = 8 + 2 + 4 * 4 + 2 * 8;  // up to the counts by channel
constexpr std::uint64_t kLongestName = 255;                       // of a compression

/// Fields read one by one from the file, so that a length that lies costs no memory.
class Fields {
 public:
  Fields(const FileSource& source, std::uint64_t body) : source_(source), begin_(body), at_(body) {}

  template <WireScalar T>
  [[nodiscard]] T get() {
    T value{};
    if (!has(sizeof(T))) return value;
    auto bytes = source_.read(at_, sizeof(T));
    if (!bytes) {
      error_ = bytes.error();
      ok_ = false;
      return value;
    }
    at_ += sizeof(T);
    return ByteReader{ByteSpan(*bytes)}.get<T>();
  }
  void skip(std::uint64_t n) {
    if (has(n)) at_ += n;
  }
  void skip_sized() { skip(get<std::uint32_t>()); }
  [[nodiscard]] std::string text(std::uint64_t longest) {
    const std::uint64_t n = get<std::uint32_t>();
    if (n > longest) ok_ = false;
    if (!has(n)) return {};
    auto bytes = source_.read(at_, n);
    if (!bytes) return {};
    at_ += n;
    return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
  }
  void refuse() { ok_ = false; }
  [[nodiscard]] Result<std::optional<std::uint64_t>> length() const {
    if (error_) return tl::unexpected<Error>(*error_);
    if (!ok_) return std::optional<std::uint64_t>{};
    return std::optional<std::uint64_t>(at_ - begin_);
  }

 private:
  bool has(std::uint64_t n) {
    ok_ = ok_ && at_ <= source_.size() && n <= source_.size() - at_;
    return ok_;
  }
  const FileSource& source_;
  std::uint64_t begin_, at_;
  bool ok_ = true;
  std::optional<Error> error_;
};

void skip_chunk(Fields& in) {
  const auto start = in.get<std::uint64_t>();
  const auto end = in.get<std::uint64_t>();
  const auto size = in.get<std::uint64_t>();
  in.skip(sizeof(std::uint32_t));
  const std::string compression = in.text(kLongestName);
  const auto stored = in.get<std::uint64_t>();
  if (start > end || size > kMaxChunkBytes || stored > kMaxChunkBytes || (compression.empty() && size != stored)) {
    in.refuse();
  }
  in.skip(stored);
}

void skip_attachment(Fields& in) {
  in.skip(2 * sizeof(std::uint64_t));
  in.skip_sized();
  in.skip_sized();
  in.skip(in.get<std::uint64_t>());
  in.skip(sizeof(std::uint32_t));
}

void skip_index(Fields& in) {
  in.skip(sizeof(std::uint16_t));
  const auto bytes = in.get<std::uint32_t>();
  if (bytes % kIndexEntry != 0) in.refuse();
  in.skip(bytes);
}

}  // namespace

Result<std::optional<std::uint64_t>> Reader::Impl::own_length(Op op, std::uint64_t at) const {
  Fields in(source, at + kRecordHeader);
  switch (op) {
    case Op::kHeader:
    case Op::kMetadata:
      in.skip_sized();
      in.skip_sized();
      break;
    case Op::kSchema:
      in.skip(sizeof(std::uint16_t));
      for (std::size_t i = 0; i < kTexts; ++i) in.skip_sized();
      break;
    case Op::kChannel:
      in.skip(2 * sizeof(std::uint16_t));
      for (std::size_t i = 0; i < kTexts; ++i) in.skip_sized();
      break;
    case Op::kChunk:
      skip_chunk(in);
      break;
    case Op::kMessageIndex:
      skip_index(in);
      break;
    case Op::kAttachment:
      skip_attachment(in);
      break;
    case Op::kStatistics:
      in.skip(kStatisticsHead);
      in.skip_sized();
      break;
    case Op::kDataEnd:
      in.skip(sizeof(std::uint32_t));
      break;
    case Op::kFooter:
      in.skip(kFooterRecord - kRecordHeader);
      break;
    default:
      return std::optional<std::uint64_t>{};
  }
  return in.length();
}

bool Reader::Impl::knows_channel(std::uint16_t id) const {
  return std::any_of(channels.begin(), channels.end(), [&](const Channel& c) { return c.id == id; });
}

Result<bool> Reader::Impl::begins(std::uint64_t at) const {
  if (at > source.size() || source.size() - at < kRecordHeader) return false;
  ENAMEL_TRY_ASSIGN(const auto bytes, source.read(at, kRecordHeader));
  const RecordHead head = *read_head(bytes);
  if (head.length > source.size() - at - kRecordHeader) return false;
  if (head.op == Op::kMessage) {
    constexpr std::uint64_t kMessageHead = 2 + 4 + 8 + 8;
    if (head.length < kMessageHead) return false;
    ENAMEL_TRY_ASSIGN(const auto id, source.read(at + kRecordHeader, sizeof(std::uint16_t)));
    return knows_channel(ByteReader{ByteSpan(id)}.get<std::uint16_t>());
  }
  ENAMEL_TRY_ASSIGN(const auto own, own_length(head.op, at));
  return own == head.length;
}

Result<std::optional<std::uint64_t>> Reader::Impl::body_length(const RecordHead& head, std::uint64_t at,
                                                               std::optional<std::uint64_t> own) const {
  using Length = std::optional<std::uint64_t>;
  const std::uint64_t room = source.size() - at - kRecordHeader;
  const std::uint64_t told = head.length;
  const bool fits = told <= room;
  const auto follows = [&](std::uint64_t length) -> Result<bool> {
    if (length == room) return true;
    return begins(at + kRecordHeader + length);
  };
  constexpr auto kReserved = std::uint8_t{0x10};  // opcodes from here on belong to later versions and to others
  if (!own) {
    if (!fits || (head.op != Op::kMessage && static_cast<std::uint8_t>(head.op) < kReserved)) return Length{};
    if (head.op != Op::kMessage) return Length(told);
    ENAMEL_TRY_ASSIGN(const bool message, begins(at));
    return message ? Length(told) : Length{};
  }
  if (*own == told) return Length(told);
  // Fields that were added at the end of a record are legal: then the next one follows upon the longer length.
  if (fits && *own < told) {
    ENAMEL_TRY_ASSIGN(const bool longer, follows(told));
    if (longer) return Length(told);
  }
  ENAMEL_TRY_ASSIGN(const bool shorter, follows(*own));
  return shorter ? own : Length{};
}

Result<std::optional<std::uint64_t>> Reader::Impl::find_record(std::uint64_t at) const {
  constexpr std::uint64_t kWindow = std::uint64_t{1} << 20U;
  constexpr std::size_t kUpper = 6;  // upper bytes of the length, 0 in every record that fits a file of 4 GB
  const auto last = static_cast<std::uint8_t>(Op::kDataEnd);
  // A message is looked for only among messages outside of chunks: one within a chunk whose head is damaged or whose
  // end is missing has no sum that vouches for it.
  const bool loose = !blocks.empty() && blocks.back().kind == Block::Kind::kLoose;
  for (; at < source.size() && source.size() - at >= kRecordHeader; at += kWindow - kRecordHeader) {
    ENAMEL_TRY_ASSIGN(const auto window, source.read(at, std::min(kWindow, source.size() - at)));
    for (std::size_t i = 0; i + kRecordHeader <= window.size(); ++i) {
      const auto op = std::to_integer<std::uint8_t>(window[i]);
      if (op < static_cast<std::uint8_t>(Op::kFooter) || op > last) continue;
      if (op == static_cast<std::uint8_t>(Op::kMessage) && !loose) continue;
      if (window[i + kUpper] != std::byte{0} || window[i + kUpper + 1] != std::byte{0} ||
          window[i + kUpper + 2] != std::byte{0}) {
        continue;
      }
      ENAMEL_TRY_ASSIGN(const bool here, begins(at + i));
      if (here) return std::optional<std::uint64_t>(at + i);
    }
    if (window.size() < kWindow) break;
  }
  return std::optional<std::uint64_t>{};
}

}  // namespace enamel::mcap
