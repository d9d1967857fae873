// Reads an MCAP file chunk by chunk. Nothing in the file is believed: lengths are checked against the file, CRCs of
// summary, chunks and attachments before use. A file without its end (killed writer) is read up to its last whole
// record.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

struct Message {
  MessageHeader header{};
  ByteSpan data{};  ///< into Chunk::records
};

/// Movable, not copyable: messages point into records.
struct Chunk {
  std::vector<std::byte> records{};
  std::vector<Message> messages{};  ///< in the order they were written
  Chunk() = default;
  Chunk(Chunk&&) noexcept = default;
  Chunk& operator=(Chunk&&) noexcept = default;
};

/// One thread. Messages outside of chunks are not read (no such file is made here).
class Reader {
 public:
  /// Errors: kFileNotFound, kFileRead, kCaptureInvalid (no MCAP file, or cut before its first record), kCaptureCorrupt
  /// (summary damaged).
  [[nodiscard]] static Result<Reader> open(const std::string& path);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  [[nodiscard]] bool truncated() const noexcept;
  [[nodiscard]] std::uint64_t file_bytes() const noexcept;
  [[nodiscard]] const std::string& library() const noexcept;
  [[nodiscard]] const std::vector<Schema>& schemas() const noexcept;
  [[nodiscard]] const std::vector<Channel>& channels() const noexcept;
  [[nodiscard]] const std::vector<ChunkIndex>& chunks() const noexcept;
  [[nodiscard]] const std::vector<AttachmentIndex>& attachments() const noexcept;
  [[nodiscard]] const std::vector<Metadata>& metadata() const noexcept;
  /// From the summary; nullopt when truncated.
  [[nodiscard]] const std::optional<Statistics>& statistics() const noexcept;

  /// Errors: kFileRead, kCaptureCorrupt (names the chunk), kCaptureInvalid (compression that is not read here).
  [[nodiscard]] Result<Chunk> chunk(std::size_t n) const;
  /// Data of attachments()[n]. Errors: kFileRead, kCaptureCorrupt (names the attachment).
  [[nodiscard]] Result<std::vector<std::byte>> attachment(std::size_t n) const;
  /// Reads the whole data section and compares its CRC: finds what no other CRC covers. Nothing to compare when
  /// truncated.
  [[nodiscard]] Result<void> verify_data_section() const;

 private:
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::mcap
