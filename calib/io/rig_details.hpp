// What a solved rig.json says of itself beside its optics: when, how good, whether it was changed since.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"

namespace enamel::calib {

enum class RigSeal { kAbsent, kIntact, kBroken };  ///< of `sha256`

struct RigResiduals {
  double rms_camera_px = 0, rms_projector_px = 0;
  int poses = 0;
  bool is_shape_solved = false;
};

struct RigDetails {
  bool is_nominal = false;  ///< design values, never solved
  std::string serial;
  std::string calibrated_at;  ///< UTC, empty when it does not say
  std::optional<double> temp_c;
  RigSeal seal = RigSeal::kAbsent;
  std::string sha256;                        ///< as the file states it
  std::vector<std::string> parameter_names;  ///< of the covariance; empty when there is none
  Eigen::MatrixXd covariance;                ///< px, rad, mm by parameter
  std::optional<RigResiduals> residuals;
  std::optional<double> response_residual;  ///< of the projector, share of full scale
};

/// From `rig.text`. What is absent or ill-formed stays empty: the optics are usable without it.
[[nodiscard]] RigDetails read_rig_details(const Rig& rig);

}  // namespace enamel::calib
