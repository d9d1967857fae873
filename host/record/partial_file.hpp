// A file that appears under its name only when it is whole. Private to this folder.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::host {

class PartialFile {
 public:
  explicit PartialFile(std::string path) : path_(std::move(path)), temporary_(path_ + ".partial") {}
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  ~PartialFile() {
    if (!committed_) std::remove(temporary_.c_str());
  }
  [[nodiscard]] const std::string& temporary() const noexcept { return temporary_; }
  /// Errors: kFileWrite.
  [[nodiscard]] Result<void> commit() {
    std::error_code ec;
    std::filesystem::rename(temporary_, path_, ec);
    if (ec) return fail(ErrorCode::kFileWrite, path_ + ": " + ec.message());
    committed_ = true;
    return {};
  }

 private:
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
};

}  // namespace enamel::host
