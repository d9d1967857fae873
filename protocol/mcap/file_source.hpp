// A file read at any position. Private to this folder.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/base/result.hpp"

namespace enamel::mcap {

class FileSource {
 public:
  FileSource() = default;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  ~FileSource();

  /// Errors: kFileNotFound, kFileRead (also for folders and devices).
  [[nodiscard]] Result<void> open(const std::string& path);
  /// Exactly n bytes. Errors: kFileRead; kCaptureCorrupt when they do not lie in the file.
  [[nodiscard]] Result<std::vector<std::byte>> read(std::uint64_t offset, std::uint64_t n) const;
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace enamel::mcap
