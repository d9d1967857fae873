#include "host/compare/compare.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/compare/percentile.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

/// The references as one mesh about the first one's origin, and which of its triangles the probe saw.
struct Union {
  Mesh mesh;
  Vec3d origin_mm = Vec3d::Zero();
  std::vector<bool> seen;  ///< one a triangle
};

Union united(std::span<const MeshFile> references, double seen_at_least) {
  Union out;
  out.origin_mm = references.empty() ? Vec3d(Vec3d::Zero()) : references.front().origin_mm;
  for (const MeshFile& file : references) {
    const auto first = static_cast<std::uint32_t>(out.mesh.vertices.size());
    const auto values = file.vertex_values.find("seen");
    const Vec3d shift = file.origin_mm - out.origin_mm;
    for (const Vec3f& v : file.mesh.vertices) {
      out.mesh.vertices.emplace_back((v.cast<double>() + shift).cast<float>());
    }
    for (const auto& t : file.mesh.triangles) {
      bool seen = true;
      for (const std::uint32_t corner : t) {
        seen = seen &&
               (values == file.vertex_values.end() || static_cast<double>(values->second[corner]) >= seen_at_least);
      }
      out.mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      out.seen.push_back(seen);
    }
  }
  return out;
}

/// Sides of the equal parts that a triangle is cut into along each of its edges.
int parts_of(const Mesh& mesh, std::size_t triangle, double sample_mm) {
  const auto corner = [&](std::size_t k) -> Vec3d { return mesh.vertices[mesh.triangles[triangle][k]].cast<double>(); };
  const Vec3d ab = corner(1) - corner(0), ac = corner(2) - corner(0);
  const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
  return std::clamp(static_cast<int>(std::ceil(longest / sample_mm)), 1, 256);
}

/// By so much fewer parts, 1 or more, where the reference is so large (a mouth in micrometres) that its samples would
/// take minutes.
double coarser(const Mesh& reference, double sample_mm) {
  constexpr double kMostSamples = 1e7;
  double samples = 0;
  for (std::size_t t = 0; t < reference.triangles.size(); ++t) {
    const double n = parts_of(reference, t, sample_mm);
    samples += n * n;
  }
  return std::max(1.0, std::sqrt(samples / kMostSamples));
}

/// Share of the seen area of the reference with the mesh near: each triangle sampled at the centres of equal parts.
double coverage_pct(const Mesh& reference, const std::vector<bool>& seen, const Mesh& moved,
                    const CompareConfig& config) {
  const TriangleTree tree(moved);
  const double fewer = coarser(reference, config.coverage_sample_mm);
  double area = 0;
  double covered = 0;
  for (std::size_t t = 0; t < reference.triangles.size(); ++t) {
    if (!seen[t]) {
      continue;
    }
    const auto corner = [&](std::size_t k) -> Vec3d {
      return reference.vertices[reference.triangles[t][k]].cast<double>();
    };
    const Vec3d a = corner(0);
    const Vec3d ab = corner(1) - a;
    const Vec3d ac = corner(2) - a;
    const int n = std::max(1, static_cast<int>(parts_of(reference, t, config.coverage_sample_mm) / fewer));
    const double part = 0.5 * ab.cross(ac).norm() / (static_cast<double>(n) * n);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        for (int down = 0; down < (i + j < n - 1 ? 2 : 1); ++down) {  // the upright and the inverted sub-triangle
          const double offset = down == 0 ? 1.0 / 3.0 : 2.0 / 3.0;
          const Vec3d p = a + ab * ((i + offset) / n) + ac * ((j + offset) / n);
          area += part;
          covered += tree.nearest(p, config.coverage_within_mm) ? part : 0.0;
        }
      }
    }
  }
  return area > 0 ? 100.0 * covered / area : 0.0;
}

double foreign_pct(const Mesh& mesh, const std::vector<float>& deviation_um, double beyond_mm) {
  double area = 0, foreign = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3f ab = mesh.vertices[t[1]] - mesh.vertices[t[0]], ac = mesh.vertices[t[2]] - mesh.vertices[t[0]];
    const double part = 0.5 * static_cast<double>(ab.cross(ac).norm());
    const bool off = std::ranges::all_of(
        t, [&](std::uint32_t v) { return std::abs(static_cast<double>(deviation_um[v])) > 1e3 * beyond_mm; });
    area += part;
    foreign += off ? part : 0.0;
  }
  return area > 0 ? 100.0 * foreign / area : 0.0;
}

void summarise(CompareResult& result) {
  std::vector<double> values(result.deviation_um.begin(), result.deviation_um.end());
  double sum = 0;
  double squares = 0;
  for (const double d : values) {
    sum += std::abs(d);
    squares += d * d;
  }
  const auto count = static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  result.median_um = percentile(values, 0.5);
  for (double& d : values) {
    d = std::abs(d);
  }
  std::sort(values.begin(), values.end());
  result.mean_abs_um = sum / count;
  result.rms_um = std::sqrt(squares / count);
  result.p95_um = percentile(values, 0.95);
  result.p99_um = percentile(values, 0.99);
  result.max_um = values.back();
}

Pose shifted(const Vec3d& by) { return Pose(Eigen::Translation3d(by)); }

/// The motion between vertices, each about its own origin: nowhere is a position far out rounded to float.
Result<Pose> place(const Mesh& mesh, const SignedSurface& reference, const Vec3d& origin_mm, const CompareInput& input,
                   CompareResult& result) {
  result.alignment = input.alignment;
  Pose T = shifted(input.mesh_origin_mm - origin_mm);
  if (input.alignment == Alignment::kBest) {
    T = input.best_T_reference_mesh == nullptr
            ? align_best(mesh, reference, T)
            : shifted(-origin_mm) * *input.best_T_reference_mesh * shifted(input.mesh_origin_mm);
  } else if (input.alignment == Alignment::kStart) {
    if (input.estimate_poses == nullptr || input.truth_poses == nullptr) {
      return fail(ErrorCode::kUsage, "--align start needs --poses and --truth-poses");
    }
    ENAMEL_TRY_ASSIGN(const StartAlignment start, align_start(*input.estimate_poses, *input.truth_poses));
    T = shifted(-origin_mm) * start.T_truth_estimate * shifted(input.mesh_origin_mm);
    result.end = start.end;
  }
  result.T_reference_mesh = shifted(origin_mm) * T * shifted(-input.mesh_origin_mm);
  return T;
}

}  // namespace

Result<CompareResult> compare(const Mesh& mesh, std::span<const MeshFile> references, const CompareInput& input,
                              const CompareConfig& config) {
  Union all = united(references, config.seen_at_least);
  if (mesh.vertices.empty() || mesh.triangles.empty() || all.mesh.triangles.empty()) {
    return fail(ErrorCode::kMeshInvalid, "nothing to compare: a mesh without triangles");
  }
  const SignedSurface reference(std::move(all.mesh));
  CompareResult result;
  ENAMEL_TRY_ASSIGN(const Pose T, place(mesh, reference, all.origin_mm, input, result));
  Mesh moved;
  moved.triangles = mesh.triangles;
  std::size_t beyond = 0;
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d p = T * v.cast<double>();
    const SignedDistance d = reference.distance(p);
    moved.vertices.emplace_back(p.cast<float>());
    result.deviation_um.push_back(static_cast<float>(1e3 * d.distance_mm));
    beyond += d.on_border ? 1U : 0U;
  }
  summarise(result);
  result.beyond_border_pct = 100.0 * static_cast<double>(beyond) / static_cast<double>(mesh.vertices.size());
  result.foreign_pct = foreign_pct(mesh, result.deviation_um, config.foreign_beyond_mm);
  result.coverage_pct = coverage_pct(reference.mesh(), all.seen, moved, config);
  return result;
}

std::string compare_json(const CompareResult& result) {
  constexpr std::array<const char*, 3> kNames{"none", "best", "start"};
  nlohmann::ordered_json j;
  j["mean_abs_um"] = result.mean_abs_um;
  j["median_um"] = result.median_um;
  j["rms_um"] = result.rms_um;
  j["p95_um"] = result.p95_um;
  j["p99_um"] = result.p99_um;
  j["max_um"] = result.max_um;
  j["coverage_pct"] = result.coverage_pct;
  j["beyond_border_pct"] = result.beyond_border_pct;
  j["foreign_pct"] = result.foreign_pct;
  j["end_error_um"] = nullptr;
  j["end_rotation_deg"] = nullptr;
  j["scale_ppm"] = nullptr;
  if (result.end) {
    j["end_error_um"] = result.end->end_error_um;
    j["end_rotation_deg"] = result.end->end_rotation_deg;
    if (result.end->scale_ppm) {
      j["scale_ppm"] = *result.end->scale_ppm;
    }
  }
  j["align"] = kNames[static_cast<std::size_t>(result.alignment)];
  return json_text(j, 2);
}

}  // namespace enamel::host
