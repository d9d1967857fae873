// State of Reader and the two ways to fill it. Private to this folder.
#pragma once

#include "protocol/mcap/file_source.hpp"
#include "protocol/mcap/reader.hpp"

namespace enamel::mcap {

struct Reader::Impl {
  FileSource source;
  bool truncated = false;
  std::string library;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<ChunkIndex> chunks;
  std::vector<AttachmentIndex> attachments;
  std::vector<Metadata> metadata;
  std::optional<Statistics> statistics;
  std::uint64_t data_end = 0;  ///< offset of the DataEnd record

  /// Magic and header record; the offset behind them.
  [[nodiscard]] Result<std::uint64_t> read_header();
  /// True when the file ends with the magic: then it has a footer, right or wrong.
  [[nodiscard]] Result<bool> has_end() const;
  [[nodiscard]] Result<void> read_summary();
  /// Walks the records from `offset` as far as they are whole.
  [[nodiscard]] Result<void> scan(std::uint64_t offset);

 private:
  [[nodiscard]] Result<void> take_summary_record(Op op, ByteSpan body);
  [[nodiscard]] Result<void> read_metadata_at(const MetadataIndex& index);
  [[nodiscard]] Result<void> take_scanned_record(Op op, std::uint64_t offset, std::uint64_t length);
  [[nodiscard]] Result<void> take_scanned_chunk(std::uint64_t offset, std::uint64_t length);
  [[nodiscard]] Result<void> take_scanned_attachment(std::uint64_t offset, std::uint64_t length);
  [[nodiscard]] tl::unexpected<Error> corrupt(const std::string& what) const {
    return fail(ErrorCode::kCaptureCorrupt, source.path() + ": " + what);
  }
};

/// Head of a chunk record: everything in front of its compressed bytes.
struct ChunkHead {
  std::uint64_t start_ns = 0, end_ns = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t crc = 0;
  std::string compression{};
  std::uint64_t compressed_size = 0;
  std::size_t bytes = 0;  ///< length of the head itself
};
[[nodiscard]] std::optional<ChunkHead> read_chunk_head(ByteSpan body);

}  // namespace enamel::mcap
