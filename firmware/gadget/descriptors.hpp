// What the probe tells FunctionFS of its USB function: one DFU interface without endpoints (docs/firmware-image.md §5).
#pragma once

#include <cstddef>
#include <vector>

#include "firmware/update/dfu_table.hpp"

namespace enamel::fw {

enum class Functional : bool { kWithout, kWith };

/// Descriptors in format v2 of linux/usb/functionfs.h, the same at each speed. kWith: the DFU functional descriptor
/// (DFU 1.1 §4.1.3) too, which kernels before 6.12 refuse with EINVAL; a host then has to be told the transfer size.
[[nodiscard]] std::vector<std::byte> function_descriptors(const DfuConfig& config, Functional functional);
/// The interface's name, in English.
[[nodiscard]] std::vector<std::byte> function_strings();

}  // namespace enamel::fw
