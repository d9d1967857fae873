// A MODEL of a DLPC347x on its bus, by its table of commands: answers what the real one would, and refuses what comes
// in the wrong order.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "firmware/device/linux/dlpc347x/i2c_bus.hpp"
#include "firmware/device/linux/dlpc347x/opcodes.hpp"

namespace enamel::fw::test {

class Dlpc347xModel final : public I2cBus {
 public:
  using Bytes = std::vector<std::uint8_t>;

  [[nodiscard]] Result<void> write(std::span<const std::uint8_t> message) override {
    ENAMEL_TRY(transaction());
    written.emplace_back(message.begin(), message.end());
    const auto payload = message.subspan(1);
    switch (message[0]) {
      case dlpc::kWriteFlashType:
        selected_ = payload[0] == dlpc::kSensingPatterns;
        break;
      case dlpc::kWriteFlashErase:
        if (selected_ && Bytes(payload.begin(), payload.end()) == Bytes{0xAA, 0xBB, 0xCC, 0xDD})
          flash.clear(), erased_ = true;
        erase_polls_ = 3;
        break;
      case dlpc::kWriteFlashLength:
        length_ = payload[0] + 256U * payload[1];
        break;
      case dlpc::kWriteFlashStart:
      case dlpc::kWriteFlashContinue:
        if (!erased_ || erase_polls_ > 0 || payload.size() != length_) ++wrong_order;
        flash.insert(flash.end(), payload.begin(), payload.end());
        break;
      case dlpc::kWriteTriggerIn:
        trigger_wanted_ = (payload[0] & 1U) != 0;
        break;
      case dlpc::kWriteMode:
        triggered = trigger_wanted_ && payload[0] == dlpc::kModeInternalPatterns;
        ready_polls_ = never_ready ? 1'000'000 : 2;
        break;
      case dlpc::kWritePatternControl:
        if (payload[0] == 0 && on_start) on_start();
        break;
      case dlpc::kWriteLedEnable:
        leds = payload[0];
        if (on_leds) on_leds(leds);
        break;
      default:
        registers[message[0]].assign(payload.begin(), payload.end());
    }
    return {};
  }

  [[nodiscard]] Result<void> write_read(std::span<const std::uint8_t> message,
                                        std::span<std::uint8_t> answer) override {
    ENAMEL_TRY(transaction());
    Bytes said = reply(message);
    said.resize(answer.size());
    std::copy(said.begin(), said.end(), answer.begin());
    return {};
  }

  /// Its watchdog has struck: everything that was written is forgotten, but for the flash.
  void restarts_by_itself() {
    registers.clear();
    leds = 0;
    triggered = trigger_wanted_ = false;
    busy_after_boot = 3;
  }

  std::vector<Bytes> written;
  std::map<std::uint8_t, Bytes> registers;
  Bytes flash;
  std::uint8_t controller = 0x0F, leds = 0xFF, system[4] = {};
  bool triggered = false;
  int wrong_order = 0;
  int boots_after = 0;      ///< transactions that are not answered
  int busy_after_boot = 0;  ///< and then so many short statuses that say: not yet
  bool main_application = true;
  bool keeps_ceiling = true;
  bool never_ready = false;
  bool never_erased = false;
  int spoiled_byte = -1;  ///< of the flash, when read back
  std::uint32_t least_us = 1677;
  std::function<void()> on_start;
  std::function<void(std::uint8_t)> on_leds;
  std::function<bool(int)> refuses;  ///< by number of the transaction: no answer

 private:
  [[nodiscard]] Result<void> transaction() {
    const int n = transactions_++;
    if (n < boots_after || (refuses && refuses(n))) return fail(ErrorCode::kProjector, "no answer");
    return {};
  }
  [[nodiscard]] Bytes reply(std::span<const std::uint8_t> message) {
    switch (message[0]) {
      case dlpc::kReadShortStatus: {
        const bool booted = busy_after_boot-- <= 0;
        const bool erasing = never_erased || erase_polls_ > 0;
        if (erase_polls_ > 0) --erase_polls_;
        return {
            static_cast<std::uint8_t>((booted ? 1U : 0U) | (main_application ? 0x80U : 0U) | (erasing ? 0x10U : 0U))};
      }
      case dlpc::kReadSystemStatus:
        return {system, system + 4};
      case dlpc::kReadController:
        return {controller};
      case dlpc::kReadVersion:
        return {5, 1, 7, 8};
      case dlpc::kReadTemperature:
        return {0x5B, 0x01};  // 347
      case dlpc::kReadLedControl:
        return registers[dlpc::kWriteLedControl];
      case dlpc::kReadLedMaxCurrent:
        return keeps_ceiling ? registers[dlpc::kWriteLedMaxCurrent] : Bytes(6, 0xFF);
      case dlpc::kReadValidateExposure:
        return validated(message);
      case dlpc::kReadPatternStatus:
        return {static_cast<std::uint8_t>(triggered && ready_polls_-- <= 0 ? 1 : 0), 1, 0, 0, 4, 2, 0};
      case dlpc::kReadFlashPrecheck:
        return {0};
      case dlpc::kReadFlashStart:
        read_at_ = 0;
        [[fallthrough]];
      case dlpc::kReadFlashContinue: {
        Bytes piece(length_);
        for (std::uint8_t& b : piece) {
          b = read_at_ < flash.size() ? flash[read_at_] : 0xFF;
          if (static_cast<int>(read_at_) == spoiled_byte) b ^= 1U;
          ++read_at_;
        }
        return piece;
      }
      default:
        return {};
    }
  }
  [[nodiscard]] Bytes validated(std::span<const std::uint8_t> message) const {
    std::uint32_t us = 0;
    for (unsigned i = 0; i < 4; ++i) us |= std::uint32_t{message[3 + i]} << (8 * i);
    Bytes answer{static_cast<std::uint8_t>(us >= least_us && message[2] == 2 ? 1 : 0)};
    for (const std::uint32_t v : {least_us, 171U, 31U}) {
      for (unsigned i = 0; i < 4; ++i) answer.push_back(static_cast<std::uint8_t>((v >> (8 * i)) & 0xFFU));
    }
    return answer;
  }

  int transactions_ = 0;
  bool selected_ = false, erased_ = false, trigger_wanted_ = false;
  int erase_polls_ = 0, ready_polls_ = 0;
  std::size_t length_ = 0, read_at_ = 0;
};

}  // namespace enamel::fw::test
