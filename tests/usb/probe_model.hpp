// A probe that is plugged into an emulated USB port: flash, bootloader, firmware that updates itself. Simulation.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/update_device.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::test {

struct ProbeOptions {
  std::string serial = "EN2-0001";
  std::uint16_t hw_rev = 2;
  bool healthy = true;  ///< the new firmware's self-test passes
  bool scanning = false;
  bool powered = true;
  std::size_t rig_bytes = 9000;  ///< random_payload(rig_bytes, 31) is its calibration; 0: none
};

class ProbeModel final : private fw::UpdateServices {
 public:
  /// Version 1.0.0 confirmed in slot A, calibration written.
  explicit ProbeModel(const ProbeOptions& options);

  /// One transfer on endpoint 0 for interface or vendor requests.
  [[nodiscard]] fw::ControlReply control(const fw::SetupPacket& setup, std::span<const std::byte> data) {
    return device_->control(setup, data);
  }
  [[nodiscard]] bool work_pending() const { return device_->work_pending(); }
  void work() { device_->work(); }
  void bus_reset() { device_->bus_reset(); }

  /// The firmware asked for a restart since the last call.
  [[nodiscard]] bool take_reboot() { return std::exchange(reboot_, false); }
  /// Bootloader, then firmware: a slot on trial tests itself and confirms, or hangs and is reset by its watchdog until
  /// its tries are gone.
  void boot();

  [[nodiscard]] const ProbeOptions& options() const { return options_; }
  [[nodiscard]] std::optional<std::size_t> running() const { return running_; }
  [[nodiscard]] image::StatusBlock status() const { return device_->status(); }
  [[nodiscard]] image::DfuState dfu_state() const { return device_->position().state; }
  /// SHA-256 of the calibration partition.
  [[nodiscard]] std::string calibration_sha() const;

 private:
  bool scanning() const noexcept override { return options_.scanning; }
  bool hold_scans() noexcept override { return !options_.scanning; }
  void let_scan() noexcept override {}
  std::uint16_t battery_mv() const noexcept override { return 3900; }
  bool power_suffices() const noexcept override { return options_.powered; }
  bool self_test() noexcept override { return options_.healthy || running_ == std::size_t{0}; }
  std::optional<std::size_t> read_calibration(std::size_t offset, std::span<std::byte> out) noexcept override;
  void reboot(bool) noexcept override { reboot_ = true; }

  void install_factory();
  void start(std::size_t slot);
  [[nodiscard]] std::optional<std::size_t> choose();

  ProbeOptions options_;
  KeyRing keys_;
  fw::FlashModel flash_;
  std::unique_ptr<fw::UpdateDevice> device_;
  std::optional<std::size_t> running_;
  bool reboot_ = false;
};

}  // namespace enamel::test
