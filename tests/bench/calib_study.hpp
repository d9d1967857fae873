// Parts of the calibration study: each returns one section of its JSON. Deterministic but for times.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "calib/judge/volume.hpp"
#include "calib/solve/solve.hpp"

namespace enamel::bench {

using Json = nlohmann::ordered_json;

inline constexpr calib::DepthRange kRange{40, 56};

/// p95_um, p95_without_scale_um, scale_ppm, bow_um (largest sag or twist at the three depths).
[[nodiscard]] Json error_json(const calib::RigState& solved, const calib::RigState& truth);

/// `folder`: data/oracle/calib-01; empty object where it is absent.
[[nodiscard]] Json rendered_study(const std::string& folder);
/// Rigs of our own generator: 30 from `first_seed` on, each with a slipped pose; 20 real boards.
[[nodiscard]] Json rigs_study(std::uint64_t first_seed);
[[nodiscard]] Json boards_study();
/// Centres of discs against the bound of their pixels.
[[nodiscard]] Json centres_study();
/// `data`: folder with opencv_stereo_chessboard and procam_graycode_chessboard.
[[nodiscard]] Json captured_study(const std::string& data);

}  // namespace enamel::bench
