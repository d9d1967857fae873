// A file that only grows, and can be cut back. Private to this folder.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/mcap/format.hpp"

namespace enamel::mcap {

class FileSink {
 public:
  FileSink() = default;
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;
  ~FileSink() { close_quietly(); }

  [[nodiscard]] Result<void> open(const std::string& path);
  /// All bytes or an error; after an error the file ends where it ended before the call.
  [[nodiscard]] Result<void> append(ByteSpan bytes);
  /// To stable storage, then closes.
  [[nodiscard]] Result<void> sync_and_close();
  void close_quietly() noexcept;
  [[nodiscard]] bool is_open() const noexcept { return fd_ >= 0; }
  [[nodiscard]] std::uint64_t position() const noexcept { return position_; }
  [[nodiscard]] std::uint32_t crc() const noexcept { return crc_; }  ///< of everything so far

 private:
  [[nodiscard]] tl::unexpected<Error> system_fail(const char* what) const;
  std::string path_;
  int fd_ = -1;
  std::uint64_t position_ = 0;
  std::uint32_t crc_ = 0;
};

}  // namespace enamel::mcap
