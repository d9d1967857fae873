// The certificate of a known artefact (docs/registration.md).
#pragma once

#include <string>
#include <string_view>

#include "pipeline/register/map/artefact.hpp"
#include "protocol/base/result.hpp"

namespace enamel::host {

/// {"spheres": [{"d_mm": 3.0}, ...], "distances_mm": [[i, j, mm, sigma_mm], ...]}. Errors: kArtefactFile.
[[nodiscard]] Result<pipeline::KnownArtefact> parse_artefact(std::string_view text);
/// Errors: of reading; kArtefactFile with the file's name.
[[nodiscard]] Result<pipeline::KnownArtefact> load_artefact(const std::string& path);

}  // namespace enamel::host
