// A session that was scanned in several goes (`enamel scan --resume`) is one recording in parts: capture.mcap,
// capture-2.mcap, capture-3.mcap, ...
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "host/record/burst_stream.hpp"

namespace enamel::host {

/// Recordings in a session's folder, in the order in which they were made; empty when there is none.
[[nodiscard]] std::vector<std::string> session_parts(const std::string& folder);
/// Where the next part goes.
[[nodiscard]] std::string next_part(const std::string& folder);

/// All parts as one stream: records in order, counts added up, rig and attachments of the first. Errors: of
/// CaptureReader::open, of any part; kRigForeign when the parts are of probes that are calibrated differently.
[[nodiscard]] Result<std::unique_ptr<BurstStream>> open_parts(const std::vector<std::string>& paths);

}  // namespace enamel::host
