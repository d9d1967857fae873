// The probe's half of an update: class and vendor requests on endpoint 0 in, replies out. Knows no USB stack;
// FunctionFS, the emulated device and the fuzzer hand it setup packets.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "firmware/update/dfu_table.hpp"
#include "firmware/update/image_receiver.hpp"
#include "protocol/image/status_block.hpp"

namespace enamel::fw {

/// What the updater asks of the rest of the probe.
class UpdateServices {
 public:
  virtual ~UpdateServices() = default;
  [[nodiscard]] virtual bool scanning() const noexcept = 0;
  /// Keeps scans from beginning until let_scan(); false while one is open. Asked again at every block.
  [[nodiscard]] virtual bool hold_scans() noexcept = 0;
  virtual void let_scan() noexcept = 0;
  [[nodiscard]] virtual std::uint16_t battery_mv() const noexcept = 0;
  /// At least 30 % charge, or powered by USB.
  [[nodiscard]] virtual bool power_suffices() const noexcept = 0;
  [[nodiscard]] virtual bool self_test() noexcept = 0;
  /// Bytes of the calibration from `offset` into `out`: how many, fewer at its end. Nothing: there is none to read.
  [[nodiscard]] virtual std::optional<std::size_t> read_calibration(std::size_t offset,
                                                                    std::span<std::byte> out) noexcept = 0;
  /// After the reply has gone out.
  virtual void reboot(bool recovery) noexcept = 0;
};

struct ControlReply {
  bool stall = false;
  std::span<const std::byte> data;  ///< for an IN transfer; valid until the next call
};

/// Not thread-safe: one thread serves the endpoint. Allocates once, in the constructor.
class UpdateDevice {
 public:
  UpdateDevice(const BootRegions& regions, const UpdateIdentity& identity, const image::Serial& serial,
               UpdateServices& services, const DfuConfig& config = {});

  /// One control transfer. `data`: what the host sent in the data stage; shorter than setup.length when the read
  /// failed, then nothing changes and the host repeats.
  [[nodiscard]] ControlReply control(const SetupPacket& setup, std::span<const std::byte> data) noexcept;
  void bus_reset() noexcept;
  /// While in appDETACH (recovery image): how long to wait for a reset, ms, before detach_timed_out() is due.
  [[nodiscard]] std::uint16_t detach_timeout_ms() const noexcept { return detach_timeout_ms_; }
  void detach_timed_out() noexcept { at_ = on_detach_timeout(at_); }

  /// The slot is being read back: call work() between transfers until this is false.
  [[nodiscard]] bool work_pending() const noexcept { return finish_pending_ && at_.state == DfuState::kManifest; }
  /// Reads at most one chunk (64 KiB) or the manifest, so that the host's next request need not wait.
  void work() noexcept;

  /// The firmware's own self-test passed. False when the block cannot be stored, in recovery, and for a firmware that
  /// was rolled back and only has not restarted yet.
  [[nodiscard]] bool confirm_running(bool commit_counter) noexcept;
  /// Ten minutes after confirmation: the minimum counter follows the confirmed slots.
  [[nodiscard]] bool raise_counter_now() noexcept;

  [[nodiscard]] DfuPosition position() const noexcept { return at_; }
  [[nodiscard]] image::StatusBlock status() const noexcept;

 private:
  [[nodiscard]] ControlReply dfu(const SetupPacket& setup, std::span<const std::byte> data) noexcept;
  [[nodiscard]] ControlReply vendor(const SetupPacket& setup, std::span<const std::byte> data) noexcept;
  [[nodiscard]] ControlReply vendor_in(image::VendorRequest request, const SetupPacket& setup) noexcept;
  [[nodiscard]] image::Checked<void> act(image::VendorRequest request, std::uint16_t value,
                                         std::span<const std::byte> data) noexcept;
  void take_block(const SetupPacket& setup, std::span<const std::byte> data) noexcept;
  [[nodiscard]] image::Checked<void> may_begin() noexcept;
  /// Something runs, and it was not rolled back.
  [[nodiscard]] bool may_confirm() const noexcept;
  [[nodiscard]] image::Checked<void> factory_reset(std::span<const std::byte> serial) noexcept;
  [[nodiscard]] image::Checked<void> store(const ControlBlock& block) noexcept;
  [[nodiscard]] ControlReply send_block(std::uint16_t length) noexcept;
  [[nodiscard]] ControlReply reply_status() noexcept;
  void fail(image::Refusal why) noexcept;
  void give_up(DfuStatus why) noexcept;

  BootRegions regions_;
  UpdateIdentity identity_;
  image::Serial serial_;
  UpdateServices* services_;
  DfuConfig config_;
  ControlStore control_;
  std::unique_ptr<ImageReceiver> receiver_;
  DfuPosition at_;
  std::uint32_t last_error_ = 0;  ///< of the last download or vendor request, also after CLRSTATUS
  std::uint16_t next_block_ = 0;
  std::uint16_t detach_timeout_ms_ = 0;
  std::size_t uploaded_ = 0;
  bool allow_older_ = false;
  bool finish_pending_ = false;
  image::StatusBytes upload_{};
  std::array<std::byte, image::kDfuTransferSize> calibration_{};
  std::array<std::byte, 6> reply_{};
};

}  // namespace enamel::fw
