// Command line of enamel-updated.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/base/result.hpp"
#include "protocol/image/status_block.hpp"

namespace enamel::fw {

struct UpdaterOptions {
  std::string flash;
  std::string functionfs;
  std::string gadget;  ///< folder in configfs; empty: somebody else connects the gadget
  std::string serial;
  std::uint16_t hw_rev = 0;
  bool development = false;
  bool in_factory = false;
  std::optional<std::size_t> slot;  ///< as the bootloader told; absent: the boot policy decides here
  bool recovery = false;
  std::string self_test;  ///< shell command
  std::string battery;    ///< folder of the power supply class
  std::string scan_lock;
  std::string calibration;  ///< rig.json as the acquisition process has it; only read
  int counter_after_s = 600;
};

[[nodiscard]] image::Serial serial_bytes(const std::string& text);

/// Nullopt: --help was asked for and printed. Errors: kUsage.
[[nodiscard]] Result<std::optional<UpdaterOptions>> parse_updater_options(int argc, const char* const* argv);

}  // namespace enamel::fw
