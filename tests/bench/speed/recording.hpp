// A recording in memory, so that no file is read while anything is measured, and its run through the scan pipeline.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/session/scan_pipeline.hpp"
#include "protocol/types/burst.hpp"

namespace enamel::bench {

struct Recording {
  std::string name;  ///< of the file, without folder and ending
  calib::Rig rig;
  std::vector<host::Accepted> bursts;  ///< in the recorded order
};

/// At most `most` bursts, 0: all. Errors: of open_bursts and parse_rig; kEmptyInput without bursts.
[[nodiscard]] Result<Recording> load_recording(const std::string& path, std::size_t most);

/// The way there, back, there again … `passes` times, each burst at the ends once, in steps of the recording's mean; a
/// pixel in every frame of each other pass is another, so that none is taken for a frame that hung. passes >= 1. Pure.
[[nodiscard]] Recording there_and_back(const Recording& recording, std::size_t passes);

/// Feeds all bursts through the real pipeline, no window, default configuration, and refines the map as a replay does.
/// workers: 0 is one thread in topological order. Errors: of ScanPipeline.
[[nodiscard]] Result<host::ScanResult> run_scan(const Recording& recording, int workers,
                                                flow::StepObserver* observer = nullptr);

}  // namespace enamel::bench
