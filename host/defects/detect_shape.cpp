#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "host/defects/detect.hpp"
#include "host/defects/place_grid.hpp"

namespace enamel::host::defects {
namespace {

/// Vertices of each cell, by cell.
struct CellVertices {
  std::vector<std::uint32_t> first, vertices;
};

CellVertices vertices_by_cell(const SurfaceCells& cells) {
  CellVertices out;
  out.first.assign(cells.size() + 1, 0);
  for (const std::uint32_t c : cells.of_vertex) ++out.first[c + 1];
  std::partial_sum(out.first.begin(), out.first.end(), out.first.begin());
  out.vertices.resize(cells.of_vertex.size());
  std::vector<std::uint32_t> next(out.first.begin(), out.first.end() - 1);
  for (std::uint32_t v = 0; v < cells.of_vertex.size(); ++v) out.vertices[next[cells.of_vertex[v]]++] = v;
  return out;
}

using Quadric = Eigen::Matrix<double, 6, 1>;

Quadric terms(double x, double y) {
  Quadric out;
  out << 1, x, y, x * x, x * y, y * y;
  return out;
}

/// Rms about the quadric over the tangent plane, um; negative with too few points.
double rms_about_quadric(const Mesh& mesh, std::uint32_t centre, const std::vector<std::uint32_t>& around) {
  constexpr std::size_t kFewest = 20;  // chosen: three times the quadric's coefficients
  if (around.size() < kFewest) return -1;
  const Vec3d n = mesh.normals[centre].cast<double>(), p = mesh.vertices[centre].cast<double>();
  const Vec3d e1 = n.unitOrthogonal(), e2 = n.cross(e1);
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Quadric right = Quadric::Zero();
  double zz = 0;
  for (const std::uint32_t v : around) {
    const Vec3d d = mesh.vertices[v].cast<double>() - p;
    const double z = n.dot(d);
    const Quadric row = terms(e1.dot(d), e2.dot(d));
    normal += row * row.transpose();
    right += z * row;
    zz += z * z;
  }
  const Quadric fit = normal.ldlt().solve(right);
  const double left = std::max(zz - fit.dot(right), 0.0);
  return kDefectUmPerMm * std::sqrt(left / static_cast<double>(around.size() - 6));
}

}  // namespace

std::vector<double> roughness_um(const Surface& s) {
  const CellVertices by_cell = vertices_by_cell(s.cells);
  std::vector<double> out(s.cells.size());
  std::vector<std::uint32_t> around;
  for (std::uint32_t c = 0; c < s.cells.size(); ++c) {
    around.clear();
    const auto take = [&](std::uint32_t cell) {
      around.insert(around.end(), by_cell.vertices.begin() + by_cell.first[cell],
                    by_cell.vertices.begin() + by_cell.first[cell + 1]);
    };
    take(c);
    for (const std::uint32_t n : s.cells.touching(c)) take(n);
    out[c] = rms_about_quadric(s.mesh, s.cells.vertex[c], around);
  }
  return out;
}

std::vector<double> smoothest_quarter(const Surface& s, const std::vector<double>& rough) {
  constexpr std::size_t kPlaceCells = 100;  // chosen: 6 mm2
  std::vector<double> out(s.cells.size(), -1);
  std::vector<std::uint32_t> reached(s.cells.size(), 0);
  std::vector<std::uint32_t> place;
  std::vector<double> values;
  for (std::uint32_t c = 0; c < s.cells.size(); ++c) {
    place.assign(1, c);
    reached[c] = c + 1;
    for (std::size_t i = 0; i < place.size() && place.size() < kPlaceCells; ++i) {
      for (const std::uint32_t n : s.cells.touching(place[i])) {
        if (reached[n] == c + 1) continue;
        reached[n] = c + 1;
        place.push_back(n);
      }
    }
    values.clear();
    for (const std::uint32_t n : place)
      if (rough[n] >= 0) values.push_back(rough[n]);
    if (values.size() < kPlaceCells / 2) continue;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
    std::ranges::nth_element(values, at);
    out[c] = *at;
  }
  return out;
}

std::vector<double> thickness_mm(const Surface& s, double within_mm) {
  constexpr double kOpposed = -0.8;  // cosine between the normals of two sides of a sheet
  constexpr double kAsideMm = 0.3;   // a cell is represented by one vertex: the other side's lies aside by as much
  PlaceGrid grid(within_mm + kAsideMm);
  for (std::uint32_t c = 0; c < s.cells.size(); ++c) grid.add(place_of(s, c), c);
  std::vector<double> out(s.cells.size(), std::numeric_limits<double>::infinity());
  for (std::uint32_t c = 0; c < s.cells.size(); ++c) {
    const Vec3d p = place_of(s, c), n = s.mesh.normals[s.cells.vertex[c]].cast<double>();
    grid.near(p, [&](std::uint32_t other) {
      if (n.dot(s.mesh.normals[s.cells.vertex[other]].cast<double>()) > kOpposed) return;
      const Vec3d d = place_of(s, other) - p;
      const double below = -n.dot(d);
      if (below <= 0 || below > within_mm || (d + below * n).norm() > kAsideMm) return;
      out[c] = std::min(out[c], below);
    });
  }
  return out;
}

void find_holes(const Surface& s, const InspectConfig& config, std::vector<Defect>& out) {
  std::vector<Defect> found;
  for (const BorderLoop& loop : s.loops) {
    if (loop.is_outer || loop.area_mm2 < config.hole_mm2) continue;
    const double roundness = 4 * std::numbers::pi * loop.area_mm2 / (loop.length_mm * loop.length_mm);
    const double width_mm = 4 * loop.area_mm2 / loop.length_mm;
    if (roundness < config.hole_roundness && width_mm < config.hole_width_mm) continue;
    found.push_back({DefectClass::kHole, loop.middle, loop.area_mm2, loop.area_mm2, config.hole_mm2,
                     confidence_of(loop.area_mm2 / config.hole_mm2),
                     "no burst measured it: scan here from another side; dry it, powder what is black"});
  }
  std::ranges::stable_sort(found, std::ranges::greater{}, &Defect::size_mm2);
  out.insert(out.end(), found.begin(), found.end());
}

void find_bridges(const Surface& s, const InspectConfig& config, std::vector<Defect>& out) {
  const std::vector<double> thick = thickness_mm(s, config.thin_mm);
  const auto thin = [&](std::uint32_t c) { return thick[c] <= config.thin_mm; };
  for (const Region& r : regions(s.mesh, s.cells, thin)) {
    const double one_side_mm2 = 0.5 * r.area_mm2;
    if (one_side_mm2 < config.thin_mm2) break;
    std::vector<double> of_region;
    for (const std::uint32_t c : r.cells) of_region.push_back(thick[c]);
    std::ranges::nth_element(of_region, of_region.begin() + static_cast<std::ptrdiff_t>(of_region.size() / 2));
    const double median = of_region[of_region.size() / 2];
    out.push_back({DefectClass::kBridge, place_of(s, r.middle), one_side_mm2, median, config.thin_mm,
                   confidence_of(one_side_mm2 / config.thin_mm2),
                   "a web spans a gap: blow the gap dry, cut the web out and scan here again"});
  }
}

void find_noise(const Surface& s, const InspectConfig& config, std::vector<Defect>& out) {
  const std::vector<double> rough = smoothest_quarter(s, roughness_um(s));
  const auto half =
      static_cast<std::size_t>(std::ranges::count_if(rough, [&](double each) { return each > config.rough_half_um; }));
  const double limit_um = 2 * half > rough.size() ? config.rough_half_um : config.rough_um;
  for (const Region& r : regions(s.mesh, s.cells, [&](std::uint32_t c) { return rough[c] > limit_um; })) {
    if (r.area_mm2 < config.rough_mm2) break;
    double sum = 0;
    for (const std::uint32_t c : r.cells) sum += std::max(rough[c], 0.0);
    const double mean = sum / static_cast<double>(r.cells.size());
    out.push_back({DefectClass::kNoise, place_of(s, r.middle), r.area_mm2, mean, limit_um,
                   confidence_of(mean / limit_um),
                   "the surface is rough with noise: clean and warm the window, go nearer, and scan here again"});
  }
}

}  // namespace enamel::host::defects
