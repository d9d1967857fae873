#include "tools/twin/surface/ball_bar.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/twin/optics/random.hpp"

namespace enamel::twin {
namespace {

constexpr std::uint64_t kCertificateStream = 0xBA75;  // of the certificate's errors
constexpr double kFacetMm = 0.2;

}  // namespace

TriSurface ball_rod(const Vec3d& a, const Vec3d& b, double radius, float albedo) {
  TriSurface out;
  constexpr std::uint32_t kSegments = 48;
  const Vec3d along = (b - a).normalized();
  const Vec3d side = along.cross(Vec3d::UnitZ()).normalized(), up = side.cross(along);
  const auto rings = static_cast<std::uint32_t>(std::ceil((b - a).norm() / kFacetMm));
  for (std::uint32_t i = 0; i <= rings; ++i) {
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kSegments;
      const Vec3d n = std::cos(angle) * side + std::sin(angle) * up;
      out.vertices.emplace_back((a + (b - a) * (double(i) / rings) + radius * n).cast<float>());
      out.normals.emplace_back(n.cast<float>());
      out.albedo.push_back(albedo);
    }
  }
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < kSegments; ++k) {
      const std::uint32_t p = i * kSegments + k, q = i * kSegments + (k + 1) % kSegments;
      out.triangles.push_back({p, p + kSegments, q + kSegments});
      out.triangles.push_back({p, q + kSegments, q});
    }
  }
  return out;
}

std::string ball_certificate(const std::vector<Ball>& balls, double sigma_mm, std::uint64_t seed) {
  const CounterRandom random(seed, kCertificateStream);
  nlohmann::json spheres = nlohmann::json::array(), distances = nlohmann::json::array();
  std::uint64_t draw = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    spheres.push_back({{"d_mm", 2 * balls[i].radius}});
    for (std::size_t j = 0; j < i; ++j) {
      const double error = sigma_mm * random.normals(draw++).a;
      distances.push_back({j, i, (balls[i].centre - balls[j].centre).norm() + error, sigma_mm});
    }
  }
  return nlohmann::json{{"spheres", spheres}, {"distances_mm", distances}}.dump(1) + "\n";
}

}  // namespace enamel::twin
