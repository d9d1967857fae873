// What the update asks of the probe around it: power, scanning, self-test, restart.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "firmware/boot/slot_image.hpp"
#include "firmware/storage/scan_lock.hpp"
#include "firmware/update/update_device.hpp"
#include "firmware/updater/options.hpp"
#include "protocol/base/clock.hpp"

namespace enamel::fw {

enum class Restart : std::uint8_t { kNormal, kRecovery };

/// Not thread-safe.
class ProbeServices final : public UpdateServices {
 public:
  /// `slot_name`: for the self-test's environment. `lock`: null when nothing scans on this probe.
  ProbeServices(const UpdaterOptions& options, std::string slot_name, ScanLock* lock, Clock& clock);

  [[nodiscard]] bool scanning() const noexcept override { return lock_ != nullptr && lock_->held_elsewhere(); }
  [[nodiscard]] bool hold_scans() noexcept override { return lock_ == nullptr || lock_->take(); }
  void let_scan() noexcept override;
  /// 0 without a battery.
  [[nodiscard]] std::uint16_t battery_mv() const noexcept override;
  [[nodiscard]] bool power_suffices() const noexcept override;
  /// Within the time that a host waits for a transfer.
  [[nodiscard]] bool self_test() noexcept override;
  [[nodiscard]] std::optional<std::size_t> read_calibration(std::size_t offset,
                                                            std::span<std::byte> out) noexcept override;
  void reboot(bool recovery) noexcept override { restart_ = recovery ? Restart::kRecovery : Restart::kNormal; }

  [[nodiscard]] bool self_test(std::chrono::milliseconds limit) noexcept;
  [[nodiscard]] std::optional<Restart> restart() const noexcept { return restart_; }

 private:
  const UpdaterOptions* options_;
  ScanLock* lock_;
  Clock* clock_;
  std::string slot_name_;
  std::optional<Restart> restart_;
};

}  // namespace enamel::fw
