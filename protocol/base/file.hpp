// Whole files in and out.
#pragma once

#include <string>
#include <string_view>

#include "protocol/base/result.hpp"

namespace enamel {

/// Errors: kFileNotFound, kFileRead.
[[nodiscard]] Result<std::string> read_file(const std::string& path);

/// Writes through a temporary file and renames it: the file appears whole or not at all, and an older one stays intact
/// on error. Errors: kFileWrite with the system's reason.
[[nodiscard]] Result<void> write_file(const std::string& path, std::string_view content);

/// Creates the folder and its parents. Errors: kFileWrite.
[[nodiscard]] Result<void> make_folder(const std::string& path);

}  // namespace enamel
