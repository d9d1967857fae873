#include "firmware/device/sim/sim_device.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "firmware/device/sim/sim_frame.hpp"

namespace enamel::fw {
namespace {

constexpr Nanoseconds kWaitSlice{20'000'000};  // how long stop() may go unnoticed
constexpr int kLedMa = 400;
constexpr std::uint8_t kLeakDn = 90;  // what a stuck LED does to a dark frame

}  // namespace

SimDevice::SimDevice(std::unique_ptr<BurstFeed> feed, Clock& clock, const SimConfig& config)
    : feed_(std::move(feed)), clock_(clock), config_(config), timeline_(config.speed) {}

Result<std::unique_ptr<SimDevice>> SimDevice::create(std::unique_ptr<BurstSource> source, Clock& clock,
                                                     const SimConfig& config) {
  if (!(config.speed >= 0.01 && config.speed <= 100)) {
    return fail(ErrorCode::kConfigValue, "speed " + std::to_string(config.speed) + ", must be from 0.01 to 100");
  }
  auto feed = std::make_unique<BurstFeed>(std::move(source), config.read_ahead);
  ENAMEL_TRY(feed->wait_first());
  std::unique_ptr<SimDevice> device(new SimDevice(std::move(feed), clock, config));
  ENAMEL_TRY(device->set_mode());
  return device;
}

Result<void> SimDevice::set_mode() {
  const SimBurst& first = feed_->first();
  ENAMEL_TRY(check_exposure(first));
  take_exposure(first.exposure_us);
  is_made_late_ = first.expose != nullptr;
  mode_ = {first.width, first.height, first.bit_depth, timeline_.scale(frame_period_ns(first)),
           static_cast<std::uint32_t>(exposure_.count() / 1000)};
  return {};
}

StretchCount SimDevice::stretched() const {
  const std::lock_guard lock(mutex_);
  return timeline_.stretched();
}

void SimDevice::set_faults(SimFaults faults) {
  const std::lock_guard lock(mutex_);
  faults_ = std::move(faults);
}

Result<void> SimDevice::start() {
  const std::lock_guard lock(mutex_);
  if (faults_.camera_unplugged) return fail(ErrorCode::kCamera, "camera disconnected");
  running_ = true;
  startup_left_ = config_.startup_frames;
  last_start_ = device_now(clock_) - mode_.frame_period;
  known_until_ = last_start_;
  return {};
}

void SimDevice::stop() noexcept {
  const std::lock_guard lock(mutex_);
  running_ = false;
  armed_ = false;
  if (next_position_ >= 0) burst_.reset();  // stopped in the middle of it
  next_position_ = SimStep::kFreeRunning;
  timeline_.forget();
  delivered_.clear();
  edges_.clear();
}

Result<CameraFrame> SimDevice::next_frame() {
  for (;;) {
    Plan step;
    {
      const std::lock_guard lock(mutex_);
      if (!running_) return fail(ErrorCode::kCancelled, "camera stopped");
      if (faults_.camera_unplugged) return fail(ErrorCode::kCamera, "camera disconnected");
      if (!delivered_.empty()) {
        CameraFrame frame = std::move(delivered_.front());
        delivered_.pop_front();
        return frame;
      }
      ENAMEL_TRY_ASSIGN(step, plan());
    }
    if (step.expose && !expose_late(step)) continue;
    if (!wait_until(step.t + exposure_ + config_.stamp_delay)) continue;
    const std::lock_guard lock(mutex_);
    if (running_) perform(step);
  }
}

/// Frames that are made after their exposure: the first one waits for all four. False when stopped meanwhile.
bool SimDevice::expose_late(const Plan& step) {
  const DeviceTime last = step.t + 3 * mode_.frame_period;
  if (!wait_until(last + exposure_)) return false;
  SimFrames frames = step.expose({step.t, step.t + (last + exposure_ - step.t) / 2, light_share_});
  const std::lock_guard lock(mutex_);
  if (!running_ || !burst_ || next_position_ != 0) return false;
  burst_->frames = std::move(frames);
  burst_->expose = {};
  return true;
}

/// False when stopped meanwhile.
bool SimDevice::wait_until(DeviceTime t) {
  for (;;) {
    const HostTime now = clock_.now();
    const HostTime end = host_time(to_ns(t));
    if (now >= end) return true;
    clock_.sleep_until(std::min(end, now + kWaitSlice));
    const std::lock_guard lock(mutex_);
    if (!running_) return false;
  }
}

Result<SimDevice::Plan> SimDevice::plan() {
  const auto k = static_cast<std::size_t>(std::max(0, next_position_));
  if (next_position_ >= 0) {
    Plan step{timeline_.map(burst_->t_exposure_ns[k]), next_position_, {}};
    if (k == 0) step.expose = burst_->expose;
    return step;
  }
  // A machine that slept does not make the camera deliver the missed frames one by one.
  const DeviceTime next = std::max(last_start_ + mode_.frame_period, device_now(clock_) - config_.max_lag);
  if (armed_ && !burst_) {
    ENAMEL_TRY_ASSIGN(auto polled, feed_->poll());
    if (polled.state == BurstFeed::State::kEnd) {
      ended_ = true;
      armed_ = false;
      return fail(ErrorCode::kCancelled, "the source has no further burst");
    }
    if (polled.burst) {
      const SimBurst& next_burst = *polled.burst;
      if (pixel_bytes(next_burst.width, next_burst.height, next_burst.bit_depth) !=
          pixel_bytes(mode_.width, mode_.height, mode_.bit_depth)) {
        return fail(ErrorCode::kImageInvalid,
                    "burst " + std::to_string(next_burst.burst_index) + " has another frame size");
      }
      ENAMEL_TRY(check_exposure(next_burst));
      burst_ = std::move(polled.burst);
    }
  }
  if (armed_ && burst_) {
    const DeviceTime sentinel = burst_start(next + mode_.frame_period) - mode_.frame_period;
    if (sentinel <= next + mode_.frame_period / 2) return Plan{sentinel, SimStep::kSentinel, {}};
  }
  return Plan{next, SimStep::kFreeRunning, {}};
}

/// Start of the loaded burst's first exposure, not before `earliest`.
DeviceTime SimDevice::burst_start(DeviceTime earliest) {
  const std::int64_t t0 = burst_->t_exposure_ns[0];
  if (!timeline_.based() || t0 <= last_source_ns_) timeline_.rebase(t0, earliest);
  const Nanoseconds late = earliest - timeline_.map(t0);
  if (late > mode_.frame_period / 8) timeline_.stretch(late);
  return timeline_.map(t0);
}

void SimDevice::perform(const Plan& plan) {
  SimStep step;
  step.position = plan.position;
  if (step.position == SimStep::kSentinel && !armed_) step.position = SimStep::kFreeRunning;  // taken back meanwhile
  if (step.position == SimStep::kSentinel) take_exposure(burst_->exposure_us);
  expose(plan, step);
  if (step.position == SimStep::kSentinel) {
    armed_ = false;
    next_position_ = 0;
    gate_open_ = true;
    step.burst_index = burst_->burst_index;
    optics_c_ = burst_->temp_c;
    pattern_set_ = burst_->pattern_set;
    step.edges.push_back({EdgeKind::kGate, plan.t + mode_.frame_period / 2, burst_->burst_index});
  } else if (step.position == 3) {
    last_source_ns_ = burst_->t_exposure_ns[3];
    burst_.reset();
    next_position_ = SimStep::kFreeRunning;
  } else if (step.position >= 0) {
    ++next_position_;
  }
  last_start_ = plan.t;
  known_until_ = plan.t + exposure_ + config_.stamp_delay;
  if (faults_.on_step) faults_.on_step(step);
  restarts_ += step.camera_restarted ? 1 : 0;
  for (CameraFrame& frame : step.frames) delivered_.push_back(std::move(frame));
  edges_.insert(edges_.end(), step.edges.begin(), step.edges.end());
}

bool SimDevice::lit() const noexcept { return faults_.led_stuck_on || (light_on_ && !faults_.led_open); }

void SimDevice::expose(const Plan& plan, SimStep& step) {
  CameraFrame frame;
  frame.sensor_seq = sensor_seq_++;
  frame.status = startup_left_ > 0 ? FrameStatus::kStartup : FrameStatus::kSuccess;
  startup_left_ = std::max(0, startup_left_ - 1);
  frame.t_sensor = plan.t + exposure_ + config_.stamp_delay;
  frame.exposure_us = static_cast<std::uint32_t>(exposure_.count() / 1000);
  frame.width = mode_.width;
  frame.height = mode_.height;
  frame.bit_depth = mode_.bit_depth;
  frame.format = unpacked_format(mode_.bit_depth);
  step.edges.push_back({EdgeKind::kStrobe, plan.t, strobes_++});
  bool pattern_shown = false;
  if (step.position >= 0) {
    step.burst_index = burst_->burst_index;
    const bool missed =
        !gate_open_ || (faults_.trigger_missed && faults_.trigger_missed(burst_->burst_index, step.position));
    if (!missed) {
      const int pattern = std::exchange(next_pattern_, (next_pattern_ + 1) % 4);
      const DeviceTime rise = plan.t + exposure_ * 3 / 100;
      if (pattern == 0) step.edges.push_back({EdgeKind::kT1, plan.t + exposure_ / 100, 0});
      step.edges.push_back({EdgeKind::kT2Rise, rise, 0});
      step.edges.push_back({EdgeKind::kT2Fall, plan.t + exposure_ * 97 / 100, 0});
      if (lit())
        frame.pixels = PixelLoan(burst_->frames[static_cast<std::size_t>(pattern)]);  // kept: it may be shown twice
      pattern_shown = lit();
    }
  }
  if (!pattern_shown) {
    const bool leak = faults_.led_stuck_on;
    frame.pixels = PixelLoan(blank_frame(mode_, leak ? kLeakDn : config_.dark_dn));
  }
  step.frames.push_back(std::move(frame));
}

Result<void> SimDevice::arm() {
  const std::lock_guard lock(mutex_);
  if (ended_) return fail(ErrorCode::kCancelled, "the source has no further burst");
  armed_ = true;
  return {};
}

void SimDevice::disarm() noexcept {
  const std::lock_guard lock(mutex_);
  armed_ = false;
}

Result<void> SimDevice::restart() {
  const std::lock_guard lock(mutex_);
  next_pattern_ = 0;
  gate_open_ = false;
  return {};
}

ProjectorStatus SimDevice::status() const {
  const std::lock_guard lock(mutex_);
  return faults_.projector;
}

int SimDevice::pattern_set() const {
  const std::lock_guard lock(mutex_);
  return pattern_set_;
}

DeviceTime SimDevice::read(std::vector<Edge>& edges) {
  const std::lock_guard lock(mutex_);
  edges.insert(edges.end(), edges_.begin(), edges_.end());
  edges_.clear();
  return known_until_;
}

void SimDevice::set_enabled(bool on) noexcept {
  const std::lock_guard lock(mutex_);
  light_on_ = on;
}

bool SimDevice::enabled() const noexcept {
  const std::lock_guard lock(mutex_);
  return light_on_;
}

int SimDevice::sensed_ma() const noexcept {
  const std::lock_guard lock(mutex_);
  return lit() ? kLedMa : 0;
}

Temperatures SimDevice::read() const {
  const std::lock_guard lock(mutex_);
  Temperatures t{.tip_cc = config_.tip_cc, .led_cc = 3800, .soc_cc = 4500, .optics_cc = std::nullopt};
  if (faults_.thermistor_open) t.tip_cc.reset();
  t.optics_cc = static_cast<std::int16_t>(std::llround(std::clamp(optics_c_, -40.0, 120.0) * 100.0));
  return t;
}

}  // namespace enamel::fw
