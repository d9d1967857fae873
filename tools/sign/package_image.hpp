// An image wrapped for fwupd: metainfo (AppStream) beside the image in a cabinet.
#pragma once

#include <string>

#include "protocol/base/result.hpp"
#include "protocol/image/manifest.hpp"

namespace enamel::sign {

/// The GUID by which fwupd knows probes in run mode: UUID version 5 (RFC 4122 §4.3, namespace DNS) of
/// "USB\VID_1209&PID_0001".
[[nodiscard]] std::string fwupd_guid();

/// The AppStream component of an image. Its version is what fwupd reads off a probe: bcdDevice, "major.minor" (fwupd's
/// format "pair"); revision and build stand in the description only.
[[nodiscard]] std::string make_metainfo(const image::Manifest& manifest);

/// Writes image and metainfo as a cabinet, uncompressed; same image, same bytes. `file`: the whole image file. Errors:
/// kFileWrite.
[[nodiscard]] Result<void> write_cabinet(const std::string& path, const std::string& file, const std::string& metainfo);

}  // namespace enamel::sign
