// State of Reader and what fills it. Private to this folder.
//
// A file is walked record by record from its begin: some thousand small reads, and nothing that stands elsewhere in the
// file (index, summary) is needed to find a record. Where a record does not fit what its own fields say, the walk looks
// for the next one that does; what lies between is a damaged block.
#pragma once

#include "protocol/mcap/file_source.hpp"
#include "protocol/mcap/reader.hpp"
#include "protocol/mcap/records.hpp"

namespace enamel::mcap {

inline constexpr std::uint64_t kMaxSmallRecord = std::uint64_t{16} << 20U;  // any record but chunks and attachments

struct Reader::Impl {
  FileSource source;
  bool truncated = false;
  std::string library;
  std::string profile;
  std::vector<Schema> schemas;
  std::vector<Channel> channels;
  std::vector<Block> blocks;
  std::vector<AttachmentIndex> attachments;
  std::vector<Metadata> metadata;
  std::optional<Statistics> statistics;
  std::vector<std::string> problems;
  std::optional<std::uint64_t> data_end;  ///< offset of the DataEnd record, when there is one

  /// Magic and header record; the offset behind them. Errors: kCaptureInvalid for what never was an MCAP file.
  [[nodiscard]] Result<std::uint64_t> read_header();
  /// All records of the data section.
  [[nodiscard]] Result<void> walk(std::uint64_t at);
  /// What stands behind the data: counts, and a second copy of schemas and channels.
  [[nodiscard]] Result<void> read_summary();

 private:
  /// Takes the record at `at` and moves behind it. False: there is none.
  [[nodiscard]] Result<bool> take_record(std::uint64_t& at);
  [[nodiscard]] Result<bool> take_body(Op op, std::uint64_t at, std::uint64_t length);
  void take_loose(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] Result<bool> take_small(Op op, std::uint64_t at, std::uint64_t length);
  [[nodiscard]] Result<bool> take_attachment(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] bool take_summary_record(Op op, ByteSpan body);

  /// Length of a record's body as its own fields tell it; nullopt for one that tells none, or no such record.
  [[nodiscard]] Result<std::optional<std::uint64_t>> own_length(Op op, std::uint64_t at) const;
  /// Length of the body at `at`: the one that its head tells, or `own` where the next record follows upon that.
  [[nodiscard]] Result<std::optional<std::uint64_t>> body_length(const RecordHead& head, std::uint64_t at,
                                                                 std::optional<std::uint64_t> own) const;
  /// A record begins here: its head and its fields agree.
  [[nodiscard]] Result<bool> begins(std::uint64_t at) const;
  /// First such place from `at` on.
  [[nodiscard]] Result<std::optional<std::uint64_t>> find_record(std::uint64_t at) const;
  [[nodiscard]] bool knows_channel(std::uint16_t id) const;

  bool ended_ = false;            ///< the data section has its end
  std::uint64_t summary_at_ = 0;  ///< first record behind it
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
