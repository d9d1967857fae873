// What runs: the bootloader's word, or its policy where there is no bootloader before us.
#pragma once

#include <optional>

#include "firmware/boot/flash_map.hpp"
#include "protocol/image/trust.hpp"

namespace enamel::fw {

/// Who says which slot runs.
struct BootWord {
  std::optional<std::size_t> slot;  ///< the bootloader started it; it is verified here again
  bool recovery = false;            ///< none was started
};

struct Running {
  std::size_t slot = 0;                        ///< in recovery the one that is left alone
  std::optional<image::ImageVersion> version;  ///< absent in recovery
  bool on_trial = false;
};

/// Without the bootloader's word choose_slot decides and stores what a trial costs. Nothing that verifies: recovery.
[[nodiscard]] Running find_running(const BootRegions& regions, const image::Hardware& hardware,
                                   const image::Trust& trust, const BootWord& told);

}  // namespace enamel::fw
