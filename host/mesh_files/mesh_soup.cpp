#include "host/mesh_files/mesh_soup.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "host/mesh_files/number_step.hpp"
#include "host/mesh_files/polygon.hpp"

namespace enamel::host {
namespace {

/// Nearer than this the origin stays where it is: float keeps 0.06 um there.
constexpr double kNearMm = 1000.0;
/// Positions farther from the others than this are none.
constexpr float kFarthestMm = 1e6F;
/// Of the longest edge squared: what double rounding leaves of three points on a line.
constexpr double kNoArea = 1e-12;

/// Looked at for polygons with dents: a second, or one of some ten thousand corners.
constexpr std::uint64_t kMostPoints = 200'000'000;

bool is_position(const Vec3f& p) {
  return std::fabs(p.x()) < kFarthestMm && std::fabs(p.y()) < kFarthestMm && std::fabs(p.z()) < kFarthestMm;
}

bool has_area(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a;
  const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()});
  return ab.cross(ac).norm() > kNoArea * longest2;
}

std::vector<Vec3d> used_positions(const MeshSoup& soup) {
  std::vector<bool> used(soup.positions.size(), false);
  for (const auto& t : soup.triangles) {
    used[t[0]] = used[t[1]] = used[t[2]] = true;
  }
  std::vector<Vec3d> out;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i] && soup.positions[i].allFinite()) {
      out.push_back(soup.positions[i]);
    }
  }
  return out;
}

/// The median of each coordinate, so that a stray vertex does not pull; whole mm, so that no digit is lost.
Vec3d origin_of(const std::vector<Vec3d>& positions) {
  Vec3d origin = Vec3d::Zero();
  std::vector<double> values(positions.size());
  for (int axis = 0; axis < 3 && !positions.empty(); ++axis) {
    std::transform(positions.begin(), positions.end(), values.begin(), [&](const Vec3d& p) { return p[axis]; });
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    origin[axis] = std::fabs(*middle) > kNearMm ? std::round(*middle) : 0.0;
  }
  return origin;
}

template <class T>
void keep_only(std::vector<T>& values, const std::vector<bool>& kept) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < values.size(); ++from) {
    if (kept[from]) {
      values[to++] = values[from];
    }
  }
  values.resize(to);
}

void leave_out_faces(MeshFile& file) {
  const auto& vertices = file.mesh.vertices;
  auto& triangles = file.mesh.triangles;
  std::vector<bool> kept;
  kept.reserve(triangles.size());
  for (const std::array<std::uint32_t, 3>& t : triangles) {
    const Vec3f &a = vertices[t[0]], &b = vertices[t[1]], &c = vertices[t[2]];
    const bool whole = is_position(a) && is_position(b) && is_position(c);
    const bool flat = whole && !has_area(a.cast<double>(), b.cast<double>(), c.cast<double>());
    file.left_out.broken_faces += whole ? 0U : 1U;
    file.left_out.flat_faces += flat ? 1U : 0U;
    kept.push_back(whole && !flat);
  }
  keep_only(triangles, kept);
  keep_only(file.synthetic, kept);
}

void leave_out_vertices(MeshFile& file) {
  Mesh& mesh = file.mesh;
  std::vector<bool> kept(mesh.vertices.size(), false);
  for (const auto& t : mesh.triangles) {
    kept[t[0]] = kept[t[1]] = kept[t[2]] = true;
  }
  std::vector<std::uint32_t> index(kept.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    index[i] = next;
    next += kept[i] ? 1U : 0U;
    const bool whole = is_position(mesh.vertices[i]);
    file.left_out.broken_vertices += whole ? 0U : 1U;
    file.left_out.unused_vertices += whole && !kept[i] ? 1U : 0U;
  }
  if (next == kept.size()) {
    return;
  }
  for (auto& t : mesh.triangles) {
    t = {index[t[0]], index[t[1]], index[t[2]]};
  }
  keep_only(mesh.vertices, kept);
  keep_only(mesh.normals, kept);
  keep_only(mesh.quality, kept);
  keep_only(mesh.soft, kept);
  for (auto& [name, values] : file.vertex_values) {
    keep_only(values, kept);
  }
}

/// What ply_bytes() wrote becomes part of the mesh again.
void take_soft(MeshFile& file) {
  const auto told = file.vertex_values.extract("soft_tissue");
  if (told.empty() || told.mapped().size() != file.mesh.vertices.size()) return;
  for (const float value : told.mapped()) file.mesh.soft.push_back(value > 0.5F ? 1 : 0);
}

}  // namespace

void MeshSoup::add_face(const std::vector<std::uint32_t>& corners) {
  short_faces += corners.size() < 3 ? 1U : 0U;
  if (corners.size() > 3) {
    fans.push_back({triangles.size(), corners.size() - 2});
  }
  for (std::size_t k = 2; k < corners.size(); ++k) {
    triangles.push_back({corners[0], corners[k - 1], corners[k]});
  }
}

void MeshSoup::tag_synthetic(bool made_up) {
  if (!made_up && synthetic.empty()) {
    tagged = triangles.size();
    return;
  }
  synthetic.resize(std::max(tagged, synthetic.size()), 0);  // those before the first that was made up
  synthetic.resize(triangles.size(), made_up ? 1 : 0);
  tagged = triangles.size();
}

Result<MeshFile> leave_out_synthetic(MeshFile file) {
  if (file.synthetic.empty()) {
    return file;
  }
  std::vector<bool> kept;
  for (const std::uint8_t made_up : file.synthetic) {
    kept.push_back(made_up == 0);
    file.left_out.synthetic_faces += made_up != 0 ? 1U : 0U;
  }
  keep_only(file.mesh.triangles, kept);
  file.synthetic.clear();
  if (file.mesh.triangles.empty()) {
    return fail(ErrorCode::kMeshInvalid, "all of its faces are synthetic: nothing was measured");
  }
  const LeftOut before = file.left_out;
  leave_out_vertices(file);
  file.left_out.unused_vertices = before.unused_vertices;  // theirs belong to the faces, which are counted
  file.left_out.broken_vertices = before.broken_vertices;
  return file;
}

Result<MeshFile> finish_mesh(MeshSoup soup, const std::string& format) {
  MeshFile file;
  std::uint64_t budget = kMostPoints;
  for (const MeshSoup::Fan& fan : soup.fans) {
    unfold_fan(std::span(soup.triangles).subspan(fan.first, fan.count), soup.positions, budget);
  }
  if (const auto used = used_positions(soup); !used.empty()) {
    file.origin_mm = origin_of(used);
    file.step_mm = number_step(used, file.origin_mm, soup.floats);
  }
  file.mesh.vertices.reserve(soup.positions.size());
  for (const Vec3d& p : soup.positions) {
    file.mesh.vertices.emplace_back((p - file.origin_mm).cast<float>());
  }
  file.mesh.normals = std::move(soup.normals);
  file.mesh.quality = std::move(soup.quality);
  file.mesh.triangles = std::move(soup.triangles);
  file.synthetic = std::move(soup.synthetic);
  if (!file.synthetic.empty()) {
    file.synthetic.resize(file.mesh.triangles.size(), 0);
  }
  file.vertex_values = std::move(soup.vertex_values);
  file.left_out.flat_faces = soup.short_faces;
  leave_out_faces(file);
  leave_out_vertices(file);
  if (file.mesh.triangles.empty()) {
    const std::string what = left_out_text(file.left_out);
    return fail(ErrorCode::kMeshInvalid, format + ": empty: no triangle" + (what.empty() ? "" : " but " + what));
  }
  take_soft(file);
  if (!std::ranges::all_of(file.mesh.normals, [](const Vec3f& n) { return n.allFinite(); })) {
    file.mesh.normals.clear();
    file.left_out.normals = true;
  }
  return file;
}

}  // namespace enamel::host
