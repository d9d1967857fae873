// An edentulous jaw: a smooth U-shaped ridge with mucosa, a profile swept along an arch. Jaw coordinates
// (path/arch.hpp), z = 0 on the crest in front.
#pragma once

#include <cstdint>

#include "tools/twin/jaw/jaw_field.hpp"
#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

struct RidgeConfig {
  double relief_um = 30;  ///< amplitude of the mucosa's fine relief; the folds in front are kFoldsToRelief as high
  double albedo = 0.6;
  double max_edge_mm = 0.1;
  double from_mm = 0, to_mm = 0;  ///< part that is meshed, arc length; equal: the whole ridge
};

/// derived: arc length of the last centres of the accuracy model (ridge.cpp), less a ball.
inline constexpr double kRidgeEndMm = 56;
/// chosen: on the pictures of rugae, a quarter of a millimetre at the relief's default.
inline constexpr double kFoldsToRelief = 8;

class RidgeField {
 public:
  RidgeField(double relief_um, std::uint64_t seed);

  static constexpr double kLipschitz = 2.0;
  /// < 0 inside; slope about 1 near the surface, never above kLipschitz.
  [[nodiscard]] double value(const Eigen::Vector3d& p) const;
  /// z of the smooth profile, without relief.
  [[nodiscard]] static double profile(const ArchCoordinates::At& a);

  [[nodiscard]] const Arch& arch() const { return arch_; }
  [[nodiscard]] const ArchCoordinates& coordinates() const { return coordinates_; }

 private:
  [[nodiscard]] double relief(const ArchCoordinates::At& a, const Eigen::Vector3d& p) const;

  double relief_mm_;
  std::uint64_t seed_;
  Arch arch_;
  ArchCoordinates coordinates_;
};

struct Ridge {
  ArchShape shape;
  TriSurface mesh;
};

[[nodiscard]] Ridge make_ridge(const RidgeConfig& config, std::uint64_t seed);

}  // namespace enamel::twin
