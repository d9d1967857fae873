// Keeps a recording safe from what its disk may do while a scan runs: hands what was written to stable storage every
// half second, watches the space that is left, and holds some back for the results.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "protocol/base/clock.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

struct DiskLimits {
  std::uint64_t warn_bytes = std::uint64_t{2} << 30U;       ///< chosen: by judgement; half a minute of raw bursts
  std::uint64_t stop_bytes = std::uint64_t{128} << 20U;     ///< chosen: by judgement; four seconds of raw bursts
  std::uint64_t reserve_bytes = std::uint64_t{256} << 20U;  ///< for mesh, poses and report of a full arch twice over
  Nanoseconds period{500'000'000};                          ///< at a power cut what is younger may be gone
};

enum class DiskState : std::uint8_t { kAmple, kLow, kFull };

/// One thread of its own. All members thread-safe but the destructor.
class DiskGuard {
 public:
  /// Free bytes for this user where the recording is; tests put in their own.
  using FreeBytes = std::function<std::uint64_t()>;
  /// `path`: the recording, which exists. `on_full` is called once, on the guard's thread.
  DiskGuard(const std::string& path, const DiskLimits& limits, std::function<void()> on_full,
            FreeBytes free_bytes = {});
  DiskGuard(const DiskGuard&) = delete;
  DiskGuard& operator=(const DiskGuard&) = delete;
  ~DiskGuard();

  [[nodiscard]] DiskState state() const noexcept { return state_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t free_bytes() const noexcept { return free_.load(std::memory_order_acquire); }
  /// For people, while a scan runs: how little is left; empty while there is enough.
  [[nodiscard]] std::string warning() const;
  /// Why a scan was ended that records to `path`, or nothing.
  [[nodiscard]] std::optional<Error> full(const std::string& path) const;
  /// Gives the space that was held back to the results: before they are written.
  void release_reserve();

 private:
  void run(const std::stop_token& stop);
  void look();

  DiskLimits limits_;
  std::function<void()> on_full_;
  FreeBytes free_bytes_;
  std::string reserve_path_;
  int fd_ = -1;
  std::atomic<DiskState> state_{DiskState::kAmple};
  std::atomic<std::uint64_t> free_{UINT64_MAX};
  std::jthread thread_;
};

}  // namespace enamel::host
