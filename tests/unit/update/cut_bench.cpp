#include "tests/unit/update/cut_bench.hpp"

#include <algorithm>
#include <stdexcept>

#include "firmware/boot/transitions.hpp"
#include "protocol/image/dfu_suffix.hpp"

namespace enamel::test {
namespace {

using namespace fw;

std::vector<std::byte> without_suffix(std::vector<std::byte> file) {
  file.resize(file.size() - image::kSuffixSize);
  return file;
}

UpdateIdentity identity(const KeyRing& keys, std::size_t running) {
  return {test_hardware(), keys.trust(), running, image::ImageVersion{1, 0, 0, 0}};
}

std::vector<std::byte> make_image(const KeyRing& keys, std::uint8_t major, std::size_t payload) {
  image::ImageDescription d = plain_description();
  d.version = {major, 0, 0, 0};
  d.security_counter = major;
  return without_suffix(build(d, random_payload(payload, major), {&keys.signer(0), 1}));
}

std::optional<image::Refusal> send(ImageReceiver& receiver, std::span<const std::byte> image) {
  receiver.restart(false);
  for (std::size_t at = 0; at < image.size(); at += image::kDfuTransferSize) {
    const std::size_t n = std::min<std::size_t>(image::kDfuTransferSize, image.size() - at);
    if (const auto taken = receiver.take(image.subspan(at, n)); !taken) return taken.error();
  }
  if (const auto finished = receiver.finish(); !finished) return finished.error();
  return std::nullopt;
}

}  // namespace

bool RememberingJudge::verifies_from_scratch(std::size_t slot) noexcept {
  return check_slot(boot_regions(*flash_).slot[slot], test_hardware(), keys_->trust(), *workspace_).has_value();
}

bool RememberingJudge::verifies(std::size_t slot) noexcept {
  const auto content = flash_->versions(flash_map::kSlot + slot * flash_map::kSlotSize, flash_map::kSlotSize);
  const auto [entry, fresh] = known_.try_emplace(content, false);
  if (fresh) entry->second = verifies_from_scratch(slot);
  return entry->second;
}

CutBench::CutBench(std::size_t old_payload, std::size_t new_payload) : judge_(keys_), flash_(flash_map::kSize) {
  const std::vector<std::byte> old_image = make_image(keys_, 1, old_payload);
  // Installed as from the factory: written by a receiver that runs in the other slot, then confirmed.
  const auto receiver = std::make_unique<ImageReceiver>(boot_regions(flash_), identity(keys_, 1));
  if (send(*receiver, old_image)) throw std::runtime_error("the old firmware was refused");
  ControlStore store(boot_regions(flash_).control);
  if (!store.store(confirm(*store.load(), 0))) throw std::runtime_error("the old firmware was not confirmed");
  new_image_ = make_image(keys_, 2, new_payload);
}

std::optional<image::Refusal> CutBench::download(FlashModel& flash, std::size_t running) const {
  const auto receiver = std::make_unique<ImageReceiver>(boot_regions(flash), identity(keys_, running));
  return send(*receiver, new_image_);
}

std::optional<std::size_t> CutBench::boot(FlashModel& flash, const BootFunction& boot) {
  judge_.look_at(flash);
  ControlStore store(boot_regions(flash).control);
  return boot(store, judge_);
}

std::optional<std::size_t> CutBench::boot_and_confirm(FlashModel& flash, const BootFunction& boot_function) {
  const std::optional<std::size_t> slot = boot(flash, boot_function);
  ControlStore store(boot_regions(flash).control);
  const std::optional<ControlBlock> block = store.load();
  if (!slot || !block || block->slot[*slot].state != SlotState::kTrial) return slot;
  if (!store.store(confirm(*block, *slot))) return slot;
  if (const auto confirmed = store.load()) static_cast<void>(store.store(raise_counter(*confirmed, false)));
  return slot;
}

}  // namespace enamel::test
