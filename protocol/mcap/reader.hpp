// Reads an MCAP file block by block, in the order of the file, in every form that the specification allows: chunks of
// any compression that is named here or none, messages outside of chunks, schemas within chunks, sums, index and
// summary left out, records of unknown opcodes. Nothing in the file is believed: lengths are checked against the file,
// CRCs of chunks and attachments before use. Of a damaged file everything is read that is whole, wherever the damage
// lies; a file without its end (killed writer) is read up to its last whole record.
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
  std::vector<Schema> schemas{};    ///< that stand among them
  std::vector<Channel> channels{};
  Chunk() = default;
  Chunk(Chunk&&) noexcept = default;
  Chunk& operator=(Chunk&&) noexcept = default;
};

/// One thread.
class Reader {
 public:
  /// Errors: kFileNotFound, kFileRead, kCaptureInvalid (no MCAP file, or cut before its first record).
  [[nodiscard]] static Result<Reader> open(const std::string& path);
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  /// The file has no end.
  [[nodiscard]] bool truncated() const noexcept;
  /// What was found damaged on opening besides blocks(): header, heads of records, summary. One line each.
  [[nodiscard]] const std::vector<std::string>& problems() const noexcept;
  [[nodiscard]] std::uint64_t file_bytes() const noexcept;
  [[nodiscard]] const std::string& profile() const noexcept;  ///< empty when the header is damaged
  [[nodiscard]] const std::string& library() const noexcept;
  /// Outside of chunks, those of the summary last; where one is damaged its copy stands here too.
  [[nodiscard]] const std::vector<Schema>& schemas() const noexcept;
  [[nodiscard]] const std::vector<Channel>& channels() const noexcept;
  [[nodiscard]] const std::vector<Block>& blocks() const noexcept;
  [[nodiscard]] const std::vector<AttachmentIndex>& attachments() const noexcept;
  [[nodiscard]] const std::vector<Metadata>& metadata() const noexcept;
  /// nullopt when there is no summary, or a damaged one.
  [[nodiscard]] const std::optional<Statistics>& statistics() const noexcept;

  /// Messages of blocks()[n]. Errors: kFileRead, kCaptureCorrupt (names the block), kCaptureInvalid (compression that
  /// is not read here).
  [[nodiscard]] Result<Chunk> read(std::size_t n) const;
  /// Data of attachments()[n]. Errors: kFileRead, kCaptureCorrupt (names the attachment).
  [[nodiscard]] Result<std::vector<std::byte>> attachment(std::size_t n) const;
  /// Reads the whole data section and compares its CRC: finds what no other CRC covers. Nothing to compare when
  /// the file is truncated or its writer left the sum out.
  [[nodiscard]] Result<void> verify_data_section() const;

 private:
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::mcap
