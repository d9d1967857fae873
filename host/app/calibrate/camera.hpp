// `enamel calibrate solve` on pictures of a chessboard without fringes: the camera alone.
#pragma once

#include <string>

#include "calib/target/target.hpp"
#include "protocol/base/result.hpp"

namespace enamel::app {

struct CameraJob {
  std::string folder;
  std::string pictures;  ///< pattern of file names in `folder`, e.g. left*.jpg; empty: poses/NN/white.png
  std::string out;
  calib::TargetDesign board;
  bool json = false;
};

/// "9x6x25": inner corners along the two sides and the side of a square in mm. Error: kUsage.
[[nodiscard]] Result<calib::TargetDesign> parse_board(const std::string& text);

/// Whether a calibration folder shows a chessboard and holds no fringes.
[[nodiscard]] bool is_camera_set(const std::string& folder);

/// Board of a calibration folder's target.json. Errors: those of read_file and parse_target.
[[nodiscard]] Result<calib::TargetDesign> board_of(const std::string& folder);

/// Writes camera.json to `out` when accepted. Value: exit code.
[[nodiscard]] Result<int> solve_camera_job(const CameraJob& job);

}  // namespace enamel::app
