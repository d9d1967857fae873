// Records of an MCAP file as values. Reference: the MCAP specification, mcap.dev/spec (version "0" of the magic).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace enamel::mcap {

using ByteSpan = std::span<const std::byte>;
using KeyValues = std::vector<std::pair<std::string, std::string>>;

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Op : std::uint8_t {
  kHeader = 1,
  kFooter,
  kSchema,
  kChannel,
  kMessage,
  kChunk,
  kMessageIndex,
  kChunkIndex,
  kAttachment,
  kAttachmentIndex,
  kStatistics,
  kMetadata,
  kMetadataIndex,
  kSummaryOffset,
  kDataEnd,
};

inline constexpr std::size_t kRecordHeader = 9;  ///< opcode and 8-byte length
inline constexpr std::size_t kFooterRecord = kRecordHeader + 8 + 8 + 4;
/// A chunk is taken into memory whole; longer ones are refused.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20U;
inline constexpr std::uint64_t kMaxAttachmentBytes = std::uint64_t{1} << 30U;

struct Schema {
  std::uint16_t id = 0;
  std::string name{};
  std::string encoding{};
  std::string data{};
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;
  std::string topic{};
  std::string message_encoding{};
};

struct MessageHeader {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_ns = 0;
  std::uint64_t publish_ns = 0;
};

struct ChunkIndex {
  std::uint64_t start_ns = 0, end_ns = 0;
  std::uint64_t offset = 0;  ///< of the chunk record in the file
  std::uint64_t length = 0;  ///< of the whole record
  std::map<std::uint16_t, std::uint64_t> message_index_offsets{};
  std::uint64_t message_index_length = 0;
  std::string compression{};
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
};

/// Where messages lie in a file, in the order of the file.
struct Block {
  enum class Kind : std::uint8_t {
    kChunk,
    kLoose,    ///< messages outside of chunks, one behind the other
    kDamaged,  ///< bytes that are no record
  };
  Kind kind = Kind::kChunk;
  std::uint64_t offset = 0, length = 0;  ///< of the whole record or records
  /// Messages by channel, as the index behind the block tells; empty without an index.
  std::map<std::uint16_t, std::uint64_t> told{};
};

struct AttachmentIndex {
  std::uint64_t offset = 0, length = 0;
  std::uint64_t log_ns = 0, create_ns = 0;
  std::uint64_t data_size = 0;
  std::string name{};
  std::string media_type{};
};

struct Metadata {
  std::string name{};
  KeyValues values{};
};

struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;
  std::string name{};
};

struct Statistics {
  std::uint64_t messages = 0;
  std::uint64_t start_ns = 0, end_ns = 0;
  std::map<std::uint16_t, std::uint64_t> per_channel{};
};

}  // namespace enamel::mcap
