// Parts of a known artefact: rods between balls, and the certificate that goes with it. mm.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/twin/surface/tri_surface.hpp"

namespace enamel::twin {

/// Open tube from a to b; its ends lie inside the balls. Precondition: it does not run along z.
[[nodiscard]] TriSurface ball_rod(const Vec3d& a, const Vec3d& b, double radius, float albedo);

/// artefact.json: diameters, and every distance as a laboratory would certify it, off by a draw of sigma_mm by the
/// seed.
[[nodiscard]] std::string ball_certificate(const std::vector<Ball>& balls, double sigma_mm, std::uint64_t seed);

}  // namespace enamel::twin
