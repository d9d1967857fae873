// Meshes whose deviations are known: a ball and a relief without symmetry.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "host/mesh_files/mesh_file.hpp"

namespace enamel::host {

/// Grid over (a, b) in [0, 1]^2, triangles wound as the grid of a sphere or height field seen from outside.
inline MeshFile grid(int na, int nb, const std::function<Vec3d(double, double)>& at) {
  MeshFile file;
  for (int j = 0; j <= nb; ++j) {
    for (int i = 0; i <= na; ++i) {
      file.mesh.vertices.push_back(at(static_cast<double>(i) / na, static_cast<double>(j) / nb).cast<float>());
    }
  }
  for (int j = 0; j < nb; ++j) {
    for (int i = 0; i < na; ++i) {
      const auto v = static_cast<std::uint32_t>(j * (na + 1) + i);
      const auto w = v + static_cast<std::uint32_t>(na) + 1;
      file.mesh.triangles.push_back({v, v + 1, w + 1});
      file.mesh.triangles.push_back({v, w + 1, w});
    }
  }
  return file;
}

inline MeshFile ball(double radius, int n = 300) {
  return grid(n, n / 2, [=](double a, double b) {
    const double lon = 2 * M_PI * a;
    const double lat = M_PI * (b - 0.5);
    return Vec3d(radius * std::cos(lat) * std::cos(lon), radius * std::cos(lat) * std::sin(lon),
                 radius * std::sin(lat));
  });
}

/// 20 x 12 mm without any symmetry, outside is +z.
inline MeshFile relief(double step_mm, const std::function<double(double, double)>& raise = {}) {
  const int na = static_cast<int>(20.0 / step_mm);
  const int nb = static_cast<int>(12.0 / step_mm);
  return grid(na, nb, [&](double a, double b) {
    const double x = 20 * a - 10;
    const double y = 12 * b - 6;
    const double z =
        1.5 * std::sin(0.7 * x + 0.2) * std::cos(0.9 * y) + 0.05 * x * y + 0.3 * std::sin(2.1 * x) + 0.02 * x * x;
    return Vec3d(x, y, z + (raise ? raise(x, y) : 0.0));
  });
}

}  // namespace enamel::host
