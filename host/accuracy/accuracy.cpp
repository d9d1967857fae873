#include "host/accuracy/accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host/compare/align.hpp"
#include "host/compare/signed_surface.hpp"

namespace enamel::host {
namespace {

constexpr double kApart_um = 200;  ///< median |d| of two surfaces that are not of one object, or were not laid together

Pose shifted(const Vec3d& by) { return Pose(Eigen::Translation3d(by)); }

struct Laid {
  std::vector<float> deviation_um;
  std::vector<bool> is_beyond;             ///< an open border
  Pose T_surface_mesh = Pose::Identity();  ///< origins included
};

Laid lay_on(const MeshFile& mesh, const SignedSurface& surface, const Vec3d& surface_origin_mm) {
  Laid out;
  const Pose T = align_best(mesh.mesh, surface, shifted(mesh.origin_mm - surface_origin_mm));
  out.T_surface_mesh = shifted(surface_origin_mm) * T * shifted(-mesh.origin_mm);
  out.deviation_um.reserve(mesh.mesh.vertices.size());
  out.is_beyond.reserve(mesh.mesh.vertices.size());
  for (const Vec3f& v : mesh.mesh.vertices) {
    const SignedDistance d = surface.distance(T * v.cast<double>());
    out.deviation_um.push_back(static_cast<float>(1e3 * d.distance_mm));
    out.is_beyond.push_back(d.on_border);
  }
  return out;
}

double beyond_pct(const Laid& laid) {
  const auto beyond = std::ranges::count(laid.is_beyond, true);
  return 100.0 * static_cast<double>(beyond) / static_cast<double>(laid.is_beyond.size());
}

/// With or without those beyond the border.
std::vector<double> counted(const Laid& laid, bool with_beyond) {
  std::vector<double> out;
  out.reserve(laid.deviation_um.size());
  for (std::size_t i = 0; i < laid.deviation_um.size(); ++i) {
    if (with_beyond || !laid.is_beyond[i]) out.push_back(static_cast<double>(laid.deviation_um[i]));
  }
  return out;
}

Result<void> check_meshes(std::span<const AccuracyRun> runs) {
  for (const AccuracyRun& run : runs) {
    if (run.file.mesh.triangles.empty() || run.file.mesh.vertices.empty())
      return fail(ErrorCode::kMeshInvalid, run.name + ": a mesh without triangles");
  }
  return {};
}

/// Figures of surfaces that do not lie on each other would mean nothing.
Result<void> check_laid(std::vector<double> deviation_um, const std::string& run, const std::string& on) {
  const std::string pair = run + " on " + on;
  constexpr std::size_t kFewest = 100;  // vertices that say anything at all
  if (deviation_um.size() < kFewest)
    return fail(ErrorCode::kMeshInvalid, pair + ": they have no surface in common after best fit");
  const auto middle = deviation_um.begin() + static_cast<std::ptrdiff_t>(deviation_um.size() / 2);
  std::ranges::nth_element(deviation_um, middle, {}, [](double d) { return std::abs(d); });
  if (std::abs(*middle) <= kApart_um) return {};
  return fail(
      ErrorCode::kMeshInvalid,
      fmt::format("{}: {:.0f} um apart after best fit (median): scans of different objects, in another unit, or "
                  "of parts that hardly overlap",
                  pair, std::abs(*middle)));
}

}  // namespace

Result<std::vector<RunDeviation>> trueness(std::span<const AccuracyRun> runs, const MeshFile& reference) {
  ENAMEL_TRY(check_meshes(runs));
  if (reference.mesh.triangles.empty()) return fail(ErrorCode::kMeshInvalid, "the reference has no triangles");
  const SignedSurface surface(reference.mesh);
  std::vector<RunDeviation> out;
  for (const AccuracyRun& run : runs) {
    const Laid laid = lay_on(run.file, surface, reference.origin_mm);
    std::vector<double> deviation_um = counted(laid, true);
    ENAMEL_TRY(check_laid(deviation_um, run.name, "the reference"));
    out.push_back({figures_of(std::move(deviation_um)), beyond_pct(laid), laid.T_surface_mesh});
  }
  return out;
}

Result<std::vector<PairDeviation>> precision(std::span<const AccuracyRun> runs) {
  ENAMEL_TRY(check_meshes(runs));
  std::vector<PairDeviation> out;
  for (std::size_t second = 1; second < runs.size(); ++second) {
    const SignedSurface surface(runs[second].file.mesh);  // one at a time: a scan's takes some 200 MB
    for (std::size_t first = 0; first < second; ++first) {
      const Laid laid = lay_on(runs[first].file, surface, runs[second].file.origin_mm);
      std::vector<double> deviation_um = counted(laid, false);
      ENAMEL_TRY(check_laid(deviation_um, runs[first].name, runs[second].name));
      out.push_back({first, second, figures_of(std::move(deviation_um)), beyond_pct(laid)});
    }
  }
  return out;
}

}  // namespace enamel::host
