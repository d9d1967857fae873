// A probe that demands of itself, at every operation of its flash, what must never happen.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/slot_image.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/update_device.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::test {

class FuzzProbe final : private fw::UpdateServices {
 public:
  static constexpr image::Serial kSerial = {'E', 'N', '2', '-', '0', '0', '7'};

  /// `factory`: a flash on which firmware is confirmed in slot A; `trusted`: digests of the manifests that may be
  /// written.
  FuzzProbe(const fw::FlashModel& factory, const KeyRing& keys, const std::set<Sha256Digest>& trusted);

  [[nodiscard]] fw::UpdateDevice& device() { return *device_; }
  [[nodiscard]] bool recovery() const { return !running_; }
  [[nodiscard]] std::optional<std::size_t> running() const { return running_; }
  [[nodiscard]] fw::ControlBlock block();

  /// One control transfer.
  fw::ControlReply control(const fw::SetupPacket& setup, std::span<const std::byte> data);
  /// The supply fails `after` operations from now, `whole` bytes into that one, until the next boot.
  void cut(std::uint64_t after, std::size_t whole, std::uint64_t seed);
  /// One copy of the boot control block becomes noise between two boots.
  void lose_control(std::size_t copy, std::uint64_t seed);
  /// Power cycle: bootloader, then the chosen firmware; or recovery when it was asked for.
  void boot(bool into_recovery);
  /// On a copy with power, when something was written since the last call: the bootloader finds a slot that verifies,
  /// for more boots than a trial has.
  void demand_bootable();

  bool is_scanning = false, has_power = true, healthy = true;

 private:
  bool scanning() const noexcept override { return is_scanning; }
  bool hold_scans() noexcept override { return !is_scanning; }
  void let_scan() noexcept override {}
  std::uint16_t battery_mv() const noexcept override { return 3900; }
  bool power_suffices() const noexcept override { return has_power; }
  bool self_test() noexcept override { return healthy; }
  std::optional<std::size_t> read_calibration(std::size_t offset, std::span<std::byte> out) noexcept override {
    constexpr std::size_t kLength = 5000;
    if (!healthy) return std::nullopt;
    return offset < kLength ? std::min(out.size(), kLength - offset) : 0;
  }
  void reboot(bool) noexcept override {}

  void watch(const fw::FlashModel::Operation& op);
  void demand_position() const;
  [[nodiscard]] bool verifies(fw::FlashModel& flash, std::size_t slot);

  class Judge;

  const KeyRing* keys_;
  const std::set<Sha256Digest>* trusted_;
  fw::FlashModel flash_;
  std::unique_ptr<fw::UpdateDevice> device_;
  std::optional<std::size_t> running_;
  std::size_t kept_ = 0;  ///< the slot that must not be written
  std::uint64_t looked_at_ = 0;
  bool resetting_ = false;  ///< a factory reset with the right serial is in hand
  std::map<std::vector<std::uint64_t>, bool> known_;
};

}  // namespace enamel::test
