// A known artefact in the field of view: balls whose distances a certificate states. It ties both ends of an arch.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace enamel::pipeline {

struct KnownArtefact {
  struct Distance {
    std::size_t i = 0, j = 0;  ///< into diameters_mm
    double mm = 0, sigma_mm = 0;
  };
  std::vector<double> diameters_mm;  ///< of each ball
  std::vector<Distance> distances;   ///< of centres; each pair once at most
};

inline constexpr std::size_t kMostBalls = 8;

/// Diameters nearer than this are looked for as one and told apart by distances alone; a ball's diameter as seen is
/// known to a fifth of it.
inline constexpr double kSameDiameter_mm = 0.1;

/// To the micrometre.
[[nodiscard]] std::string mm_text(double mm);

/// What makes it unusable, in words; empty: nothing.
[[nodiscard]] std::string fault_of(const KnownArtefact& artefact);

}  // namespace enamel::pipeline
