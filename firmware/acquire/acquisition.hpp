// The acquisition thread: runs camera, gate and assembler, hands whole bursts on, counts the others. Owns the capture
// side of the hardware while it runs; the light goes through the LightSwitch.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "firmware/acquire/acquisition_port.hpp"
#include "firmware/acquire/assembler.hpp"
#include "firmware/acquire/burst_ledger.hpp"
#include "firmware/acquire/delay_calibration.hpp"
#include "firmware/acquire/frame_pixels.hpp"
#include "firmware/acquire/light_switch.hpp"
#include "firmware/acquire/sequencer.hpp"
#include "firmware/hal/hardware.hpp"

namespace enamel::fw {

struct AcquisitionConfig {
  std::size_t calibration_frames = 200;
  Nanoseconds max_delay_spread = kUsualStampSpread;
  int leaks_to_stuck = 3;   ///< dark frames in a row with light in them: the LED is stuck on
  int dark_led_frames = 3;  ///< frames in a row without current although switched on: the LED has failed
};

/// What the publisher needs: it works later, when the camera has its memory back.
struct CapturedBurst {
  ScanTag session;
  AssembledBurst burst;  ///< its frames without pixels
  BurstPixels pixels;
  Nanoseconds frame_period{};
  std::int16_t temp_centi_c = 0;
  std::uint8_t pattern_set = 0;
};
/// Called on the acquisition thread; must not wait.
using BurstHandler = std::function<void(CapturedBurst)>;

/// All members thread-safe.
class Acquisition final : public AcquisitionPort {
 public:
  Acquisition(const Hardware& hardware, LightSwitch& light, BurstLedger& ledger, BurstHandler handler,
              const AcquisitionConfig& config = {});
  ~Acquisition() override;
  Acquisition(const Acquisition&) = delete;
  Acquisition& operator=(const Acquisition&) = delete;

  void scan(ScanTag session, std::optional<std::uint64_t> limit) override;
  void self_test() override;
  void calibrate() override;
  void drain() override;
  void abort() override;
  [[nodiscard]] Result<void> set_exposure(std::uint32_t exposure_us) override {
    return hw_.camera.set_exposure(exposure_us);
  }
  [[nodiscard]] AcquisitionReport report() const override;
  /// As calibrate() measured it last.
  [[nodiscard]] std::optional<StampDelay> stamp_delay() const;

 private:
  enum class Job { kNone, kScan, kSelfTest, kCalibrate };
  struct Request {
    Job job = Job::kNone;
    std::uint64_t number = 0;
    ScanTag session;
    std::optional<std::uint64_t> limit;
  };

  void begin(Job job, ScanTag session = {}, std::optional<std::uint64_t> limit = std::nullopt);
  void run(const std::stop_token& stop);
  [[nodiscard]] AcquisitionReport do_job(const Request& request);
  [[nodiscard]] AcquisitionReport run_scan(const Request& request);
  [[nodiscard]] AcquisitionReport run_self_test();
  [[nodiscard]] AcquisitionReport run_calibration();
  [[nodiscard]] AcquisitionReport scan_loop(const Request& request, BurstAssembler& assembler);
  [[nodiscard]] std::optional<AcquisitionReport> measure_again(BurstAssembler& assembler, ScanTag session);
  void settle(BurstAssembler& assembler, ScanTag session);
  [[nodiscard]] std::optional<AcquisitionReport> arm_next(bool under_way);
  [[nodiscard]] bool led_failed();
  [[nodiscard]] Result<CameraFrame> next_frame();
  [[nodiscard]] Result<CameraFrame> frame_with_edges(std::vector<Edge>& edges, DeviceTime& known_until);
  [[nodiscard]] bool aborted() const;
  [[nodiscard]] bool drain_asked() const;

  Hardware hw_;
  LightSwitch& light_;
  BurstLedger& ledger_;
  BurstHandler handler_;
  AcquisitionConfig config_;
  Sequencer sequencer_;
  std::uint64_t begun_seen_ = 0;
  std::uint64_t restarts_seen_ = 0;
  std::int16_t optics_cc_ = 0;
  int pattern_set_ = 0;
  int dark_led_frames_ = 0;
  Nanoseconds stamp_delay_{20'000};
  std::atomic<std::uint64_t> beats_{0};

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Request> request_;
  AcquisitionReport report_;
  std::optional<StampDelay> measured_delay_;
  std::uint64_t requests_ = 0;     ///< asked for so far; a request's number
  std::uint64_t current_ = 0;      ///< being worked on
  std::uint64_t abort_until_ = 0;  ///< requests up to this number are aborted …
  std::uint64_t drain_until_ = 0;  ///< … or drained
  std::jthread thread_;            ///< last member: stops before the others go
};

}  // namespace enamel::fw
