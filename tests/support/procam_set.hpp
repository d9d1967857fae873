// data/calib/procam_graycode_chessboard: a captured chessboard under Gray code, read into poses that the solver takes.
// Its README says what lies in the folder.
#pragma once

#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/solve/solve.hpp"

namespace enamel::test {

struct ProcamSet {
  calib::TargetDesign board;
  calib::Rig nominal;  ///< sizes and a guess of the optics; the solver starts from the pictures
  std::vector<calib::PoseView> views;
  std::vector<std::string> rejected;  ///< poses in which the board was not found
};

[[nodiscard]] inline std::string procam_folder(const std::string& shared) {
  return shared + "/data/calib/procam_graycode_chessboard";
}

/// The board is paper on 0.7 m, one corner bent: priors of its shape for solve().
[[nodiscard]] inline calib::SolveOptions procam_options() {
  calib::SolveOptions options;
  options.shape_prior = {.in_plane_mm = 0.2, .out_of_plane_mm = 2};
  return options;
}

/// Decodes every pose: a pixel has a coordinate where white and black differ by at least 20 DN. Gray code is good to a
/// projector pixel; its variance is taken as 1/12 px². Error: that of the file that cannot be read.
[[nodiscard]] Result<ProcamSet> load_procam(const std::string& folder);

}  // namespace enamel::test
