#include "pipeline/register/map/artefact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace enamel::pipeline {
namespace {

std::string fault_of_distance(const KnownArtefact& a, std::size_t n) {
  const KnownArtefact::Distance& d = a.distances[n];
  const std::string name = "distance " + std::to_string(n) + " ";
  if (d.i >= a.diameters_mm.size() || d.j >= a.diameters_mm.size())
    return name + "names a sphere that is not there: spheres count from 0";
  if (d.i == d.j) return name + "is one of a sphere to itself";
  if (!(d.mm > 0) || !(d.sigma_mm > 0)) return name + "or its sigma is not positive";
  if (d.sigma_mm > kSameDiameter_mm) return name + "has a sigma above 0.1 mm: nothing that a map could be tied to";
  if (d.mm < (a.diameters_mm[d.i] + a.diameters_mm[d.j]) / 2)
    return name + "is shorter than two spheres that touch: " + mm_text(d.mm) + " mm";
  for (std::size_t m = 0; m < n; ++m) {
    const KnownArtefact::Distance& e = a.distances[m];
    if (std::minmax(e.i, e.j) == std::minmax(d.i, d.j)) return name + "is stated twice";
  }
  return {};
}

/// Distances of three spheres that no three points have.
std::string fault_of_triangles(const KnownArtefact& a) {
  const std::size_t count = a.diameters_mm.size();
  std::vector<double> mm(count * count, 0), sigma(count * count, 0);
  for (const auto& d : a.distances) {
    mm[d.i * count + d.j] = mm[d.j * count + d.i] = d.mm;
    sigma[d.i * count + d.j] = sigma[d.j * count + d.i] = d.sigma_mm;
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      for (std::size_t k = 0; k < count; ++k) {
        const double across = mm[i * count + j], one = mm[i * count + k], two = mm[k * count + j];
        if (across == 0 || one == 0 || two == 0) continue;
        constexpr double kSigmas = 5;  // of three certified distances together
        const double slack = kSigmas * std::hypot(sigma[i * count + j], sigma[i * count + k], sigma[k * count + j]);
        if (across <= one + two + slack) continue;
        return "spheres " + std::to_string(i) + ", " + std::to_string(j) + " and " + std::to_string(k) +
               " form no triangle: " + mm_text(across) + " mm is longer than " + mm_text(one) + " and " + mm_text(two) +
               " mm together";
      }
    }
  }
  return {};
}

}  // namespace

std::string mm_text(double mm) {
  const std::string out = std::to_string(mm);
  constexpr std::size_t kPointAndDigits = 4;
  return out.substr(0, out.find('.') + kPointAndDigits);
}

std::string fault_of(const KnownArtefact& artefact) {
  if (artefact.diameters_mm.size() < 2) return "fewer than two spheres";
  if (artefact.diameters_mm.size() > kMostBalls) return "more than " + std::to_string(kMostBalls) + " spheres";
  for (std::size_t i = 0; i < artefact.diameters_mm.size(); ++i) {
    const double d = artefact.diameters_mm[i];
    if (!(d > 0) || !std::isfinite(d)) return "sphere " + std::to_string(i) + " has no positive diameter";
  }
  if (artefact.distances.empty()) return "no distances";
  for (std::size_t n = 0; n < artefact.distances.size(); ++n) {
    if (std::string fault = fault_of_distance(artefact, n); !fault.empty()) return fault;
  }
  return fault_of_triangles(artefact);
}

}  // namespace enamel::pipeline
