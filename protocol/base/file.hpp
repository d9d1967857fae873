// Whole files in and out.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/base/result.hpp"

namespace enamel {

/// Errors: kFileNotFound, kFileRead.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

/// When a file has to outlast a power cut. kLater: one of very many, whose index is written at the end.
enum class Sync : std::uint8_t { kNow, kLater };

/// Writes through a temporary file and renames it: the file appears whole or not at all, also after a power cut, and an
/// older one stays intact on error. Errors: kFileWrite with the system's reason.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view content, Sync sync = Sync::kNow);

/// Creates the folder and its parents. Errors: kFileWrite.
[[nodiscard]] Result<void> make_folder(const std::string& path);

}  // namespace enamel
