// A whole probe in software: free-running camera, gated projector, trigger edges, LED and temperatures in one
// consistent virtual device. What the sensor sees comes from a BurstSource. SIMULATION ONLY.
//
// Between bursts the camera delivers dark frames at its period. When armed, the next burst of the source is played at
// its recorded distance from the one before: a dark sentinel one period ahead, the gate, then four lit frames with
// their edges at the source's exact frame distances. When the source or the machine is too slow, everything later moves
// and stretched() says by how much.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "firmware/device/device.hpp"
#include "firmware/device/sim/burst_feed.hpp"
#include "firmware/device/sim/play_timeline.hpp"

namespace enamel::fw {

struct SimConfig {
  std::string model = "enamel twin";
  double speed = 1.0;                ///< 0.5: the whole device in slow motion, exposure and frame period included
  std::size_t read_ahead = 3;        ///< bursts; 0 = read when needed
  int startup_frames = 2;            ///< not usable after each start of the camera
  std::uint8_t dark_dn = 2;          ///< of frames without light, in 8-bit levels
  Nanoseconds stamp_delay{20'000};   ///< of the sensor stamp behind the end of exposure
  Nanoseconds max_lag{100'000'000};  ///< scheduling delays up to this are made good, longer ones stretch time
  std::int16_t tip_cc = 3650;
};

/// One exposure before it is delivered. Fault injection changes it at will.
struct SimStep {
  static constexpr int kFreeRunning = -2;
  static constexpr int kSentinel = -1;
  int position = kFreeRunning;  ///< 0…3: lit frame of the burst
  std::uint64_t burst_index = 0;
  std::vector<CameraFrame> frames;
  std::vector<Edge> edges;
  bool camera_restarted = false;
};

struct SimFaults {
  std::function<void(SimStep&)> on_step;
  std::function<bool(std::uint64_t burst_index, int position)> trigger_missed;
  bool led_open = false;      ///< no light whatever is commanded
  bool led_stuck_on = false;  ///< light in dark frames too
  bool thermistor_open = false;
  bool camera_unplugged = false;
  ProjectorStatus projector{.ready = true, .sequence_abort = false, .watchdog = false};
};

class SimDevice final : public Device,
                        public Camera,
                        public Projector,
                        public EdgeStream,
                        public Light,
                        public Thermal {
 public:
  /// Waits for the source's first burst. Errors: the source's; kEmptyInput; kConfigValue (frame times or sizes not
  /// usable, speed outside 0.01 … 100).
  [[nodiscard]] static Result<std::unique_ptr<SimDevice>> create(std::unique_ptr<BurstSource> source, Clock& clock,
                                                                 const SimConfig& config);

  // Device
  [[nodiscard]] Hardware hardware() noexcept override { return {*this, *this, *this, *this, *this}; }
  [[nodiscard]] std::string model() const override { return config_.model + (feed_->simulated() ? ", SIMULATED" : ""); }
  [[nodiscard]] const std::string& rig_text() const noexcept override { return feed_->rig_text(); }
  [[nodiscard]] StretchCount stretched() const override;
  [[nodiscard]] Nanoseconds lateness() const override { return feed_->lateness(); }
  /// A picture may take its time.
  [[nodiscard]] Nanoseconds max_silence() const override { return Nanoseconds{60'000'000'000}; }
  /// Thread-safe; takes effect with the next frame.
  void set_faults(SimFaults faults);

  // Camera. next_frame(): kCancelled also when armed and the source has no further burst.
  [[nodiscard]] CameraMode mode() const override { return mode_; }
  [[nodiscard]] Result<void> start() override;
  void stop() noexcept override;
  [[nodiscard]] Result<CameraFrame> next_frame() override;
  /// Of a source whose light is made when it is exposed; its period stays, which is the limit.
  [[nodiscard]] Result<void> set_exposure(std::uint32_t exposure_us) override;
  [[nodiscard]] std::uint64_t restarts() const override {
    const std::lock_guard lock(mutex_);
    return restarts_;
  }
  // Projector
  [[nodiscard]] Result<void> arm() override;
  void disarm() noexcept override;
  [[nodiscard]] Result<void> restart() override;
  [[nodiscard]] ProjectorStatus status() const override;
  [[nodiscard]] int pattern_set() const override;
  // EdgeStream
  [[nodiscard]] DeviceTime read(std::vector<Edge>& edges) override;
  // Light
  void set_enabled(bool on) noexcept override;
  [[nodiscard]] bool enabled() const noexcept override;
  [[nodiscard]] int sensed_ma() const noexcept override;
  // Thermal
  [[nodiscard]] Temperatures read() const override;

 private:
  struct Plan {
    DeviceTime t{};
    int position = SimStep::kFreeRunning;
    std::function<SimFrames(const SimExposure&)> expose = {};  ///< of the burst's first frame, where it is made late
  };

  SimDevice(std::unique_ptr<BurstFeed> feed, Clock& clock, const SimConfig& config);
  [[nodiscard]] Result<void> set_mode();
  [[nodiscard]] Result<Plan> plan();
  [[nodiscard]] DeviceTime burst_start(DeviceTime earliest);
  [[nodiscard]] bool wait_until(DeviceTime t);
  [[nodiscard]] bool expose_late(const Plan& step);
  void take_exposure(std::uint32_t source_us);
  void perform(const Plan& plan);
  void expose(const Plan& plan, SimStep& step);
  [[nodiscard]] bool lit() const noexcept;

  std::unique_ptr<BurstFeed> feed_;
  Clock& clock_;
  SimConfig config_;
  CameraMode mode_;
  bool is_made_late_ = false;  ///< the source's light: when it is exposed

  mutable std::mutex mutex_;    ///< all below
  Nanoseconds exposure_{};      ///< of the burst that is played, or was last
  double light_share_ = 1;      ///< of it, beside what the source planned
  std::uint32_t asked_us_ = 0;  ///< by the host; 0: nothing
  SimFaults faults_;
  PlayTimeline timeline_;
  bool running_ = false;
  bool armed_ = false;
  bool light_on_ = false;
  bool ended_ = false;
  int startup_left_ = 0;
  int next_position_ = SimStep::kFreeRunning;  ///< 0…3 inside a burst
  int next_pattern_ = 0;                       ///< of the projector's sequence
  bool gate_open_ = false;
  std::optional<SimBurst> burst_;  ///< loaded, or being played
  std::int64_t last_source_ns_ = 0;
  double optics_c_ = 25;
  int pattern_set_ = 0;
  DeviceTime last_start_{};
  DeviceTime known_until_{};
  std::uint32_t sensor_seq_ = 0;
  std::uint64_t strobes_ = 0, restarts_ = 0;
  std::deque<CameraFrame> delivered_;
  std::vector<Edge> edges_;
};

}  // namespace enamel::fw
