// A small valid rig.json as text, and edits of it.
#pragma once

#include <string>

namespace enamel::test {

inline const std::string kRigText = R"({"format": "rig/1", "units": "mm",
 "camera": {"width": 640, "height": 480, "fx": 1707, "fy": 1706.5, "cx": 321.3, "cy": 238.1, "dist": [-0.05, 0.01, 0.0003, -0.0002, 0.0]},
 "projector": {"width": 854, "height": 480, "fx": 1605, "fy": 1605, "cx": 425.2, "cy": 241.7, "dist": [-0.04, 0.008, -0.0002, 0.00035, 0.0]},
 "T_proj_cam": [[0.9780710283534462,-0.0026180810687370464,0.2082551539509883,-10.038591588904948],[0.0029458320687185957,0.9999948625950572,-0.0012636680400027857,-0.10966797569653343],[-0.20825077567455835,0.0018494418103676643,0.9780737160336815,1.8305878417255612],[0,0,0,1]],
 "patterns": {"mode": "T", "axis": "u", "period_px": 24.0, "steps": 4, "polarity_code": "-++++-+---++---+", "first_cell": 0, "mean": 127.0, "amplitude": 120.0},
 "depth_range_mm": [40, 56],
 "noise": {"full_well_e": 10000, "read_noise_e": 5, "bits": 8, "gain_e_per_dn": 39.84, "black_dn": 4}})";

/// kRigText with the first `from` replaced by `to`; an edit that finds nothing is a defect of the test and gives "".
inline std::string rig_text_with(const std::string& from, const std::string& to) {
  const auto at = kRigText.find(from);
  if (at == std::string::npos) return {};
  return std::string(kRigText).replace(at, from.size(), to);
}

}  // namespace enamel::test
