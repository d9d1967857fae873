// A Camera made of requests: frames in order of completion, lent and queued again, restarted when they stop coming.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "firmware/device/linux/camera/loan_desk.hpp"
#include "firmware/device/linux/camera/request_source.hpp"
#include "protocol/base/clock.hpp"
#include "protocol/base/spsc_ring.hpp"

namespace enamel::fw {

struct RequestCameraConfig {
  CameraControls controls;
  int startup_frames = 3;    ///< after each start, not usable: sensors settle
  int least_lent = 8;        ///< with fewer buffers than these, frames are copied: a burst would hold them all
  int control_delay = 2;     ///< frames from a request that changes exposure or gain to those that show it
  int missing_periods = 25;  ///< no frame for so long: the camera has stopped …
  Nanoseconds least_wait{100'000'000};  ///< … or for so long, where that is more
  int restarts = 3;                     ///< in a row, then kCamera
  Nanoseconds first_pause{50'000'000};  ///< before the first of them, twice as long before each further one
};

/// What went wrong since the camera was made.
struct CameraCounts {
  std::uint64_t errors = 0;        ///< frames that the driver calls damaged
  std::uint64_t out_of_order = 0;  ///< completed behind a later one, or twice
  std::uint64_t overflows = 0;     ///< nobody read: the ring was full
  std::uint64_t starved = 0;       ///< no frame for a while because all buffers were lent
  std::uint64_t restarts = 0;
};

/// stop() from any thread, all else from one.
class RequestCamera final : public Camera, private CompletionSink {
 public:
  /// Errors: kCamera when the system refuses an eventfd; kConfigValue for controls that contradict each other.
  [[nodiscard]] static Result<std::unique_ptr<RequestCamera>> create(std::shared_ptr<RequestSource> source,
                                                                     Clock& clock, const RequestCameraConfig& config);
  ~RequestCamera() override;
  RequestCamera(const RequestCamera&) = delete;
  RequestCamera& operator=(const RequestCamera&) = delete;

  [[nodiscard]] CameraMode mode() const override;
  [[nodiscard]] Result<void> start() override;
  void stop() noexcept override;
  [[nodiscard]] Result<CameraFrame> next_frame() override;
  [[nodiscard]] std::uint64_t restarts() const override { return counts().restarts; }

  /// New exposure or gain, for frames after the delay; those before it come as kStartup.
  void change(const CameraControls& controls);
  [[nodiscard]] CameraCounts counts() const;

 private:
  enum class Wait : std::uint8_t { kFrame, kTimeout, kStopped, kGone };

  RequestCamera(std::shared_ptr<RequestSource> source, Clock& clock, const RequestCameraConfig& config, int event);
  void completed(const Completion& completion) noexcept override;
  void disconnected() noexcept override;
  void wake() noexcept;
  [[nodiscard]] Result<void> open();
  [[nodiscard]] Wait wait();
  [[nodiscard]] Result<void> restart();
  [[nodiscard]] CameraFrame frame_of(const Completion& completion);
  [[nodiscard]] PixelLoan own_copy(const PixelLoan& lent) const;
  [[nodiscard]] FrameStatus status_of(const Completion& completion);

  const RequestCameraConfig config_;
  const StreamFormat format_;
  const int slots_;
  Clock& clock_;
  const int event_;  ///< eventfd: something came, or the wait is over
  const std::shared_ptr<LoanDesk> desk_;
  SpscRing<Completion> ring_;
  std::atomic<bool> running_{false};
  std::atomic<bool> gone_{false};
  std::atomic<std::uint64_t> overflows_{0};

  mutable std::mutex mutex_;  ///< below
  CameraControls controls_;
  CameraCounts counts_;
  int unsettled_ = 0;              ///< frames until what was asked for is what is seen
  bool change_under_way_ = false;  ///< asked for, its request not yet back
  int restarts_in_a_row_ = 0;
  std::optional<std::uint32_t> last_sequence_;
};

}  // namespace enamel::fw
