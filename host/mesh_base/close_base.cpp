#include "host/mesh_base/close_base.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_set>
#include <utility>
#include <vector>

#include "host/mesh_base/foot_polygon.hpp"
#include "host/mesh_base/hole_patch.hpp"
#include "host/mesh_base/sheet.hpp"
#include "protocol/base/json_text.hpp"

namespace enamel::host {
namespace {

/// The base's plane and how a shadow falls on it.
struct Ground {
  Vec3d up, u, v;  ///< right-handed u, v, up
  double plane_mm = 0;

  [[nodiscard]] Vec2d shadow(const Vec3f& p) const { return {p.cast<double>().dot(u), p.cast<double>().dot(v)}; }
  [[nodiscard]] Vec3f foot(const Vec2d& at) const { return (at.x() * u + at.y() * v + plane_mm * up).cast<float>(); }
};

Vec3d area_vector(const std::vector<Vec3f>& vertices, const Triangle& t) {
  const Vec3d a = vertices[t[0]].cast<double>();
  return 0.5 * (vertices[t[1]].cast<double>() - a).cross(vertices[t[2]].cast<double>() - a);
}

double surface_area(const std::vector<Vec3f>& vertices, const std::vector<Triangle>& faces) {
  double sum = 0;
  for (const Triangle& t : faces) sum += area_vector(vertices, t).norm();
  return sum;
}

Result<Vec3d> up_of(const Sheet& sheet, const BaseConfig& config) {
  Vec3d sum = Vec3d::Zero();
  for (const Triangle& t : sheet.triangles) sum += area_vector(sheet.vertices, t);
  const Vec3d up = config.up.value_or(sum);
  if (!up.allFinite() || !(up.norm() > 1e-9))
    return fail(ErrorCode::kMeshInvalid,
                config.up ? "the direction up has no length" : "the surface is closed: it needs no base");
  return Vec3d(up.normalized());
}

Ground ground_under(const Sheet& sheet, const Vec3d& up, const BaseConfig& config) {
  Ground out{up, up.unitOrthogonal(), Vec3d::Zero()};
  out.v = up.cross(out.u);
  double lowest = 0;
  for (std::size_t k = 0; k < sheet.vertices.size(); ++k) {
    const double height = sheet.vertices[k].cast<double>().dot(up);
    lowest = k == 0 ? height : std::min(lowest, height);
  }
  out.plane_mm = lowest - config.below_mm;
  return out;
}

std::vector<Vec2d> shadow_of(const Loop& loop, const Sheet& sheet, const Ground& ground) {
  std::vector<Vec2d> out;
  for (const std::uint32_t v : loop) out.push_back(ground.shadow(sheet.vertices[v]));
  return out;
}

/// Leaves out what cannot have a base: dust, and pieces whose outer border looks down or has no shadow.
void keep_pieces(Sheet& sheet, const Vec3d& up, const BaseConfig& config, ClosedMesh& out) {
  const Pieces pieces = pieces_of(sheet.triangles);
  std::vector<double> area(pieces.count, 0.0), upward(pieces.count, 0.0);
  double whole = 0;
  for (std::size_t f = 0; f < sheet.triangles.size(); ++f) {
    const Vec3d a = area_vector(sheet.vertices, sheet.triangles[f]);
    area[pieces.of_face[f]] += a.norm();
    upward[pieces.of_face[f]] += a.dot(up);
    whole += a.norm();
  }
  std::vector<bool> kept(sheet.triangles.size());
  for (std::size_t f = 0; f < kept.size(); ++f) {
    const std::uint32_t piece = pieces.of_face[f];
    kept[f] = area[piece] >= config.least_share * whole && upward[piece] > 0;
  }
  const auto before = sheet.triangles.size();
  keep_faces(sheet, kept);
  out.left_out_faces += before - sheet.triangles.size();
  out.left_out_pieces += pieces.count - pieces_of(sheet.triangles).count;
}

/// Outer border of each piece: that of the largest shadow.
std::vector<std::size_t> outer_borders(const Sheet& sheet, const std::vector<Loop>& loops, const Ground& ground) {
  const Pieces pieces = pieces_of(sheet.triangles);
  std::vector<std::uint32_t> piece_of(sheet.vertices.size());
  for (std::size_t f = 0; f < sheet.triangles.size(); ++f)
    for (const std::uint32_t v : sheet.triangles[f]) piece_of[v] = pieces.of_face[f];
  std::vector<std::pair<double, std::size_t>> best(pieces.count, {0.0, loops.size()});
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const double area = signed_area(shadow_of(loops[k], sheet, ground));
    auto& of = best[piece_of[loops[k].front()]];
    if (area > of.first) of = {area, k};
  }
  std::vector<std::size_t> out;
  for (const auto& [area, k] : best)
    if (k < loops.size()) out.push_back(k);
  return out;
}

class BaseBuilder {
 public:
  BaseBuilder(const Sheet& sheet, const Ground& ground, const BaseConfig& config, ClosedMesh& out)
      : sheet_(sheet), ground_(ground), config_(config), out_(out) {
    for (const Triangle& t : sheet.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        joined_.insert(edge_key(std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])));
  }

  /// Walls and bottom under one piece. False where the border has no shadow to stand on.
  [[nodiscard]] bool stand(const Loop& loop) {
    const FootPolygon foot = uncrossed(shadow_of(loop, sheet_, ground_));
    if (foot.points.size() < 3) return false;
    const auto first = static_cast<std::uint32_t>(out_.mesh.vertices.size());
    for (const Vec2d& at : foot.points) out_.mesh.vertices.push_back(ground_.foot(at));
    std::vector<Triangle> walls, bottom;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::size_t next = (k + 1) % loop.size();
      const std::uint32_t a = loop[k], b = loop[next], foot_a = first + foot.of[k], foot_b = first + foot.of[next];
      walls.push_back({b, a, foot_a});
      if (foot_a != foot_b) walls.push_back({b, foot_a, foot_b});
    }
    const Ears ears = cut_ears(foot.points);
    for (const auto& [a, b, c] : ears.triangles) bottom.push_back({first + a, first + c, first + b});
    out_.crossings += foot.crossings;
    out_.folded += ears.folded;
    out_.wall_mm2 += add(walls);
    out_.bottom_mm2 += add(bottom);
    return true;
  }

  void close(const Loop& loop) {
    double round_mm = 0;
    for (std::size_t k = 0; k < loop.size(); ++k)
      round_mm += static_cast<double>((sheet_.vertices[loop[k]] - sheet_.vertices[loop[(k + 1) % loop.size()]]).norm());
    out_.large_holes += round_mm > config_.hole_mm ? 1U : 0U;
    ++out_.holes;
    const auto joined = [this](std::uint32_t a, std::uint32_t b) {
      return joined_.contains(edge_key(std::min(a, b), std::max(a, b)));
    };
    out_.hole_mm2 += add(close_hole(loop, out_.mesh.vertices, joined));
  }

 private:
  double add(const std::vector<Triangle>& faces) {
    out_.mesh.triangles.insert(out_.mesh.triangles.end(), faces.begin(), faces.end());
    return surface_area(out_.mesh.vertices, faces);
  }

  const Sheet& sheet_;
  const Ground& ground_;
  const BaseConfig& config_;
  ClosedMesh& out_;
  std::unordered_set<std::uint64_t> joined_;
};

tl::unexpected<Error> nothing_looks_up() {
  return fail(ErrorCode::kMeshInvalid,
              "no piece of the surface has a border below it: give the direction up from the bottom to the teeth");
}

}  // namespace

Result<ClosedMesh> close_base(const Mesh& surface, const BaseConfig& config) {
  ClosedMesh out;
  Sheet sheet = clean_sheet(surface);
  out.left_out_faces = sheet.left_out_faces;
  if (sheet.triangles.empty()) return fail(ErrorCode::kMeshInvalid, "no surface");
  ENAMEL_TRY_ASSIGN(out.up, up_of(sheet, config));
  keep_pieces(sheet, out.up, config, out);
  if (sheet.triangles.empty()) return nothing_looks_up();
  const Ground ground = ground_under(sheet, out.up, config);
  out.plane_mm = ground.plane_mm;
  out.mesh.vertices = sheet.vertices;
  out.mesh.triangles = sheet.triangles;
  out.measured_vertices = sheet.vertices.size();
  out.measured_faces = sheet.triangles.size();
  const std::vector<Loop> loops = borders(sheet);
  const std::vector<std::size_t> outer = outer_borders(sheet, loops, ground);
  BaseBuilder builder(sheet, ground, config, out);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (std::ranges::find(outer, k) == outer.end())
      builder.close(loops[k]);
    else if (!builder.stand(loops[k]))
      return nothing_looks_up();
  }
  out.check = check_watertight(out.mesh);
  out.pieces = out.check.pieces;
  if (!out.check.holds()) return fail(ErrorCode::kInternal, "the base is not watertight: " + leaks_text(out.check));
  return out;
}

std::string base_json(const ClosedMesh& c) {
  const nlohmann::ordered_json out{
      {"synthetic", true},
      {"measured_faces", c.measured_faces},
      {"synthetic_faces", c.synthetic_faces()},
      {"pieces", c.pieces},
      {"left_out", {{"pieces", c.left_out_pieces}, {"faces", c.left_out_faces}}},
      {"holes_closed", c.holes},
      {"large_holes_closed", c.large_holes},
      {"area_mm2", {{"walls", c.wall_mm2}, {"bottom", c.bottom_mm2}, {"holes", c.hole_mm2}}},
      {"volume_mm3", c.check.volume_mm3},
      {"watertight", c.check.holds()},
      {"up", {c.up.x(), c.up.y(), c.up.z()}},
      {"plane_mm", c.plane_mm},
      {"leaning_walls", c.crossings},
      {"folded_bottom_faces", c.folded}};
  return json_text(out, 1);
}

}  // namespace enamel::host
