// What runs: the bootloader's word, or its policy where there is no bootloader before us.
#pragma once

#include <optional>

#include "firmware/boot/flash_map.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::fw {

struct Running {
  std::optional<std::size_t> slot;  ///< nothing: recovery
  image::ImageVersion version;
  bool on_trial = false;
};

/// `told`: the bootloader started this slot, which is verified here again. Otherwise choose_slot decides and stores what
/// a trial costs. Nothing that verifies: recovery.
[[nodiscard]] Running find_running(const BootRegions& regions, const image::Hardware& hardware,
                                   const image::Trust& trust, std::optional<std::size_t> told);

}  // namespace enamel::fw
