#include "firmware/updater/start.hpp"

#include <memory>

#include "firmware/boot/policy.hpp"
#include "firmware/boot/slot_image.hpp"

namespace enamel::fw {
namespace {

class FlashJudge final : public SlotJudge {
 public:
  FlashJudge(const BootRegions& regions, const image::Hardware& hardware, const image::Trust& trust)
      : regions_(&regions), hardware_(hardware), trust_(trust) {}

  bool verifies(std::size_t slot) noexcept override { return version_of(slot).has_value(); }
  [[nodiscard]] std::optional<image::ImageVersion> version_of(std::size_t slot) noexcept {
    const auto manifest = check_slot(regions_->slot[slot], hardware_, trust_, *workspace_);
    return manifest ? std::optional(manifest->version) : std::nullopt;
  }

 private:
  const BootRegions* regions_;
  image::Hardware hardware_;
  image::Trust trust_;
  std::unique_ptr<SlotWorkspace> workspace_ = std::make_unique<SlotWorkspace>();
};

}  // namespace

Running find_running(const BootRegions& regions, const image::Hardware& hardware, const image::Trust& trust,
                     const BootWord& told) {
  FlashJudge judge(regions, hardware, trust);
  ControlStore store(regions.control);
  std::optional<std::size_t> slot = told.slot;
  if (!slot && !told.recovery) slot = choose_slot(store, judge);
  const std::optional<image::ImageVersion> version = slot ? judge.version_of(*slot) : std::nullopt;
  if (!version) return {slot_to_keep(store, judge), std::nullopt, false};
  const std::optional<ControlBlock> block = store.load();
  return {*slot, version, block && block->slot[*slot].state == SlotState::kTrial};
}

}  // namespace enamel::fw
