#include "firmware/device/linux/camera/request_camera.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>

#include "firmware/device/linux/camera/stamp_clock.hpp"
#include "firmware/hal/hardware.hpp"
#include "protocol/base/log.hpp"
#include "protocol/base/slept.hpp"

namespace enamel::fw {
namespace {

Result<void> check(const CameraControls& c) {
  const Nanoseconds exposure{std::int64_t{c.exposure_us} * 1000};
  if (c.exposure_us > 0 && c.frame_period.count() > 0 && exposure <= c.frame_period) return {};
  return fail(ErrorCode::kConfigValue, "camera: exposure " + std::to_string(c.exposure_us) + " us in a frame of " +
                                           std::to_string(c.frame_period.count() / 1000) + " us");
}

}  // namespace

Result<std::unique_ptr<RequestCamera>> RequestCamera::create(std::shared_ptr<RequestSource> source, Clock& clock,
                                                             const RequestCameraConfig& config) {
  ENAMEL_TRY(check(config.controls));
  const int event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (event < 0) return fail(ErrorCode::kCamera, std::string("eventfd: ") + std::strerror(errno));
  return std::unique_ptr<RequestCamera>(new RequestCamera(std::move(source), clock, config, event));
}

RequestCamera::RequestCamera(std::shared_ptr<RequestSource> source, Clock& clock, const RequestCameraConfig& config,
                             int event)
    : config_(config),
      format_(source->format()),
      slots_(source->slots()),
      clock_(clock),
      event_(event),
      desk_(std::make_shared<LoanDesk>(source)),
      ring_(2 * static_cast<std::size_t>(source->slots())),
      controls_(config.controls) {}

RequestCamera::~RequestCamera() {
  stop();
  ::close(event_);
}

CameraMode RequestCamera::mode() const {
  const std::lock_guard lock(mutex_);
  return {format_.width, format_.height, format_.bit_depth, controls_.frame_period, controls_.exposure_us};
}

Result<void> RequestCamera::start() {
  if (gone_.load(std::memory_order_acquire)) return fail(ErrorCode::kCamera, "camera disconnected");
  restarts_in_a_row_ = 0;
  running_.store(true, std::memory_order_release);
  return open();
}

Result<void> RequestCamera::open() {
  // What nobody read before the last stop; its buffers are not lent.
  while (ring_.front() != nullptr) ring_.pop();
  CameraControls controls;
  {
    const std::lock_guard lock(mutex_);
    controls = controls_;
    unsettled_ = config_.startup_frames;
    change_under_way_ = false;
    last_sequence_.reset();
  }
  return desk_->open(controls, *this);
}

void RequestCamera::stop() noexcept {
  running_.store(false, std::memory_order_release);
  desk_->close();
  wake();
}

void RequestCamera::completed(const Completion& completion) noexcept {
  desk_->hold(completion.status == FrameStatus::kError || completion.status == FrameStatus::kCancelled);
  if (completion.status == FrameStatus::kCancelled) return;
  if (!ring_.push(completion)) overflows_.fetch_add(1, std::memory_order_relaxed);
  wake();
}

void RequestCamera::disconnected() noexcept {
  gone_.store(true, std::memory_order_release);
  wake();
}

void RequestCamera::wake() noexcept {
  const std::uint64_t one = 1;
  static_cast<void>(!::write(event_, &one, sizeof one));  // full: it is awake
}

RequestCamera::Wait RequestCamera::wait() {
  const Nanoseconds timeout = std::max(config_.least_wait, mode().frame_period * config_.missing_periods);
  const HostTime end = clock_.now() + timeout;
  for (;;) {
    if (!running_.load(std::memory_order_acquire)) return Wait::kStopped;
    if (ring_.front() != nullptr) return Wait::kFrame;
    if (gone_.load(std::memory_order_acquire)) return Wait::kGone;
    const Nanoseconds left = end - clock_.now();
    if (left.count() <= 0) return Wait::kTimeout;
    pollfd event{event_, POLLIN, 0};
    static_cast<void>(::poll(&event, 1, static_cast<int>(left.count() / 1'000'000) + 1));
    std::uint64_t woken = 0;
    static_cast<void>(!::read(event_, &woken, sizeof woken));
  }
}

Result<CameraFrame> RequestCamera::next_frame() {
  for (;;) {
    switch (wait()) {
      case Wait::kStopped:
        return fail(ErrorCode::kCancelled, "camera stopped");
      case Wait::kGone:
        return fail(ErrorCode::kCamera, "camera disconnected");
      case Wait::kTimeout:
        ENAMEL_TRY(restart());
        break;
      case Wait::kFrame: {
        const Completion completion = *ring_.front();
        ring_.pop();
        return frame_of(completion);
      }
    }
  }
}

/// A frame is overdue.
Result<void> RequestCamera::restart() {
  if (desk_->lent() == slots_) {
    const std::lock_guard lock(mutex_);
    ++counts_.starved;
    return fail(ErrorCode::kCamera, "camera starved: all of its buffers are lent and none comes back");
  }
  if (restarts_in_a_row_ >= config_.restarts) {
    return fail(ErrorCode::kCamera, "camera delivers no frame, not even after " + std::to_string(restarts_in_a_row_) +
                                        " restarts: is its cable seated, is the trigger it waits for there?");
  }
  const Nanoseconds pause = config_.first_pause * (1 << restarts_in_a_row_);
  ++restarts_in_a_row_;
  {
    const std::lock_guard lock(mutex_);
    ++counts_.restarts;
  }
  log::warn("camera", "no frame for a while: restart {} of {}", restarts_in_a_row_, config_.restarts);
  desk_->close();
  clock_.sleep_for(pause);
  if (running_.load(std::memory_order_acquire)) ENAMEL_TRY(open());
  // stop() may have come between the two.
  if (!running_.load(std::memory_order_acquire)) desk_->close();
  return {};
}

CameraFrame RequestCamera::frame_of(const Completion& completion) {
  CameraFrame frame;
  auto pixels = desk_->lend(completion.slot);
  if (pixels) frame.pixels = slots_ < config_.least_lent ? own_copy(*pixels) : *pixels;
  frame.format = format_.pixels;
  frame.width = format_.width;
  frame.height = format_.height;
  frame.bit_depth = format_.bit_depth;
  frame.sensor_seq = completion.sequence;
  frame.t_sensor = monotonic_stamp(completion.stamp_ns, device_now(clock_), slept());
  const std::lock_guard lock(mutex_);
  frame.exposure_us = completion.exposure_us.value_or(controls_.exposure_us);
  frame.analogue_gain_q8 = completion.analogue_gain_q8.value_or(controls_.analogue_gain_q8);
  frame.status = pixels ? status_of(completion) : FrameStatus::kError;
  if (!pixels) ++counts_.out_of_order;
  return frame;
}

PixelLoan RequestCamera::own_copy(const PixelLoan& lent) const {
  const auto bytes = lent.bytes();
  return PixelLoan({bytes.begin(), bytes.end()}, format_.stride);
}

/// Needs the lock.
FrameStatus RequestCamera::status_of(const Completion& completion) {
  if (completion.status == FrameStatus::kError) {
    ++counts_.errors;
    return FrameStatus::kError;
  }
  restarts_in_a_row_ = 0;
  if (last_sequence_ && static_cast<std::int32_t>(completion.sequence - *last_sequence_) <= 0) {
    ++counts_.out_of_order;
  } else {
    last_sequence_ = completion.sequence;
  }
  if (desk_->changed_by(completion.slot)) {
    change_under_way_ = false;
    unsettled_ = config_.control_delay;
  }
  if (change_under_way_) return FrameStatus::kStartup;
  if (unsettled_ == 0) return completion.status;
  --unsettled_;
  return FrameStatus::kStartup;
}

void RequestCamera::change(const CameraControls& controls) {
  const std::lock_guard lock(mutex_);
  controls_ = controls;
  change_under_way_ = true;
  desk_->change(controls);
}

CameraCounts RequestCamera::counts() const {
  const std::lock_guard lock(mutex_);
  CameraCounts counts = counts_;
  counts.overflows = overflows_.load(std::memory_order_relaxed);
  return counts;
}

}  // namespace enamel::fw
