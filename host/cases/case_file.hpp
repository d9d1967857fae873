// case.json: what a case's folder holds, and how its parts lie.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/cases/place_case.hpp"

namespace enamel::host {

/// Of one part's folder, as its recording and its report say; empty: they do not.
struct PartFacts {
  std::string name = {};
  bool scanned = false;  ///< there is a mesh
  bool simulated = false;
  std::string scanned_at = {};  ///< UTC
  std::string mount_serial = {}, rig_serial = {};
  std::uint64_t stops = 0;
  std::optional<double> fine_rms_um = {};  ///< how far overlapping surfaces of its stops lie apart
  std::vector<std::string> older = {};     ///< folders of scans before this one
};

/// One sentence for each serial that is not the same in all parts: sizes of another table or head are others.
[[nodiscard]] std::vector<std::string> serial_doubts(const std::vector<PartFacts>& parts);

/// `placed`: null where the parts have not been laid on each other since one was scanned. `warnings`: sentences.
[[nodiscard]] std::string case_json(const std::vector<PartFacts>& parts, const PlacedCase* placed,
                                    const std::vector<std::string>& warnings);

}  // namespace enamel::host
