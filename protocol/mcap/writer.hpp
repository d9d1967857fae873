// Writes an MCAP file: chunks with CRC and message index, summary with indexes, statistics and offsets. What has been
// handed to the system stays readable whatever happens after: a chunk is written whole or cut off again.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "protocol/base/result.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

struct WriterOptions {
  std::string profile{};
  std::string library{};
  bool compress = true;                            ///< zstd at its fastest level
  std::size_t chunk_bytes = std::size_t{1} << 20;  ///< a chunk is closed when it is this long
};

/// One thread. Order: a schema, its channel, that channel's messages; attachments and metadata anywhere; then close().
/// Errors of all members: kFileWrite. The first one cuts the file back to its last whole record and closes it; failed()
/// is true from then on and every later call fails at once.
class Writer {
 public:
  [[nodiscard]] static Result<Writer> create(const std::string& path, const WriterOptions& options);
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();  ///< without close(): pending chunk is written, no summary

  /// Ids count from 1. Schemas and channels stand between chunks, in front of those that use them, so that a damaged
  /// chunk takes none with it.
  [[nodiscard]] Result<std::uint16_t> add_schema(std::string_view name, std::string_view encoding,
                                                 std::string_view data);
  [[nodiscard]] Result<std::uint16_t> add_channel(std::uint16_t schema_id, std::string_view topic,
                                                  std::string_view message_encoding);
  [[nodiscard]] Result<void> write_message(const MessageHeader& header, ByteSpan data);
  [[nodiscard]] Result<void> write_attachment(std::string_view name, std::string_view media_type, ByteSpan data);
  [[nodiscard]] Result<void> write_metadata(const Metadata& metadata);
  /// Closes the pending chunk and hands it to the system.
  [[nodiscard]] Result<void> flush();
  [[nodiscard]] Result<void> close();
  [[nodiscard]] bool failed() const noexcept;

 private:
  struct Impl;
  explicit Writer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace enamel::mcap
