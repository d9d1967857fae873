// The buffers between the camera and whoever reads them.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "firmware/device/linux/camera/request_source.hpp"

namespace enamel::fw {

/// Lends filled buffers, queues what comes back. Thread-safe; loans may outlive the camera, but keep the source.
class LoanDesk : public std::enable_shared_from_this<LoanDesk> {
 public:
  explicit LoanDesk(std::shared_ptr<RequestSource> source);

  /// Starts the source and queues all that is not lent. Errors: the source's.
  [[nodiscard]] Result<void> open(const CameraControls& controls, CompletionSink& sink);
  void close() noexcept;
  /// Nullopt for a buffer that the camera should not have: completed twice.
  [[nodiscard]] std::optional<PixelLoan> lend(int slot);
  /// From a damaged frame to the next sound one: what comes back is kept. A camera that is being unplugged fails every
  /// request at once, and libcamera 0.0.3 aborts the program when one ends behind the unplugging. Takes no lock.
  void hold(bool yes) noexcept { held_.store(yes, std::memory_order_release); }
  /// Travels with the next buffer that is queued.
  void change(const CameraControls& controls);
  /// The request of this slot carried a change; asked once.
  [[nodiscard]] bool changed_by(int slot);
  /// Buffers that the camera cannot fill.
  [[nodiscard]] int lent() const;

 private:
  enum class Where : std::uint8_t { kIdle, kQueued, kLent };

  void give_back(int slot) noexcept;
  [[nodiscard]] Result<void> queue(int slot);
  void queue_kept() noexcept;

  std::shared_ptr<RequestSource> source_;
  mutable std::mutex mutex_;
  bool open_ = false;
  std::atomic<bool> held_{false};
  std::vector<Where> where_;
  std::vector<bool> carries_change_;
  std::optional<CameraControls> change_;
};

}  // namespace enamel::fw
