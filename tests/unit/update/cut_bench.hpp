// A probe that is updated while its supply may fail: installed firmware, new image, boot model, judge with a memory.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/slot_image.hpp"
#include "firmware/device/sim/flash_model.hpp"
#include "firmware/update/image_receiver.hpp"
#include "tests/support/firmware_image.hpp"

namespace enamel::test {

/// Verifies slots of a FlashModel from scratch, and remembers by content so that nothing is hashed twice.
class RememberingJudge final : public fw::SlotJudge {
 public:
  explicit RememberingJudge(const KeyRing& keys) : keys_(&keys) {}
  void look_at(fw::FlashModel& flash) { flash_ = &flash; }
  [[nodiscard]] bool verifies(std::size_t slot) noexcept override;
  [[nodiscard]] bool verifies_from_scratch(std::size_t slot) noexcept;

 private:
  const KeyRing* keys_;
  fw::FlashModel* flash_ = nullptr;
  std::map<std::vector<std::uint64_t>, bool> known_;
  std::unique_ptr<fw::SlotWorkspace> workspace_ = std::make_unique<fw::SlotWorkspace>();
};

/// How a bootloader chooses; nothing: recovery. A parameter, so that bad policies can be shown to fail.
using BootFunction = std::function<std::optional<std::size_t>(fw::ControlStore&, fw::SlotJudge&)>;

class CutBench {
 public:
  /// Old firmware confirmed in slot A; `new_payload` bytes wait to be installed.
  CutBench(std::size_t old_payload, std::size_t new_payload);

  [[nodiscard]] fw::FlashModel& flash() { return flash_; }
  [[nodiscard]] const KeyRing& keys() const { return keys_; }
  [[nodiscard]] RememberingJudge& judge() { return judge_; }
  [[nodiscard]] std::span<const std::byte> new_image() const { return new_image_; }

  /// Downloads the new image into `flash` as the firmware in `running` does, in blocks of the transfer size. What was
  /// refused, or nothing when it was made PENDING.
  [[nodiscard]] std::optional<image::Refusal> download(fw::FlashModel& flash, std::size_t running) const;
  /// Boots; a slot on trial confirms itself and raises the counter, as the firmware does after its self-test.
  std::optional<std::size_t> boot_and_confirm(fw::FlashModel& flash, const BootFunction& boot);
  /// Boots only: the power fails before the self-test.
  std::optional<std::size_t> boot(fw::FlashModel& flash, const BootFunction& boot);

 private:
  KeyRing keys_;
  RememberingJudge judge_;
  fw::FlashModel flash_;
  std::vector<std::byte> new_image_;
};

}  // namespace enamel::test
