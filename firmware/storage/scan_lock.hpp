// Scans and updates exclude each other across two processes: an advisory lock (flock) on a file that both know.
#pragma once

#include <memory>
#include <string>

#include "protocol/base/result.hpp"

namespace enamel::fw {

/// Not thread-safe. The lock ends with the process, however that ends.
class ScanLock {
 public:
  /// Makes the file where it is missing. kFileWrite when that is not possible.
  [[nodiscard]] static Result<std::unique_ptr<ScanLock>> open(const std::string& path);
  ~ScanLock();
  ScanLock(const ScanLock&) = delete;
  ScanLock& operator=(const ScanLock&) = delete;

  /// This process holds it from now on, or did before. False: the other one does.
  [[nodiscard]] bool take() noexcept;
  void release() noexcept;
  [[nodiscard]] bool held_elsewhere() const noexcept;

 private:
  explicit ScanLock(int fd) noexcept : fd_(fd) {}

  int fd_;
  bool held_ = false;
};

}  // namespace enamel::fw
