// What the probe tells FunctionFS of its USB function: one DFU interface without endpoints (docs/firmware-image.md §5).
#pragma once

#include <cstddef>
#include <vector>

namespace enamel::fw {

/// Descriptors in format v2 of linux/usb/functionfs.h, the same at each speed. `functional`: with the DFU functional
/// descriptor (DFU 1.1 §4.1.3), which kernels before 6.12 refuse with EINVAL; a host then has to be told the transfer
/// size.
[[nodiscard]] std::vector<std::byte> function_descriptors(bool functional);
/// The interface's name, in English.
[[nodiscard]] std::vector<std::byte> function_strings();

}  // namespace enamel::fw
