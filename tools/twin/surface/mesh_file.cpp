#include "tools/twin/surface/mesh_file.hpp"

#include <array>
#include <bit>
#include <cstring>

#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/log.hpp"

namespace enamel::twin {

Result<TriSurface> load_mesh(const std::string& path, float albedo) {
  ENAMEL_TRY_ASSIGN(host::MeshFile file, host::read_mesh(path));
  if (!file.origin_mm.isZero(0)) {
    return fail(ErrorCode::kMeshInvalid, path + ": lies more than 1 m from the origin of the scene");
  }
  if (const std::string left_out = host::left_out_text(file.left_out); !left_out.empty()) {
    log::warn("twin", "{}: left out: {}", path, left_out);
  }
  TriSurface mesh;
  mesh.vertices = std::move(file.mesh.vertices);
  mesh.triangles = std::move(file.mesh.triangles);
  mesh.albedo.assign(mesh.vertices.size(), albedo);
  compute_normals(mesh);
  return mesh;
}

std::string write_ply(const TriSurface& mesh, std::span<const std::uint8_t> seen) {
  std::string out = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\n";
  if (!seen.empty()) out += "property uchar seen\n";
  if (!mesh.material.empty()) out += "property uchar material\n";
  if (!mesh.film.empty()) out += "property float film_mm\n";
  out += "element face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    std::array<char, 12> v{};
    std::memcpy(v.data(), mesh.vertices[i].data(), v.size());
    out.append(v.data(), v.size());
    if (!seen.empty()) out.push_back(static_cast<char>(seen[i]));
    if (!mesh.material.empty()) out.push_back(static_cast<char>(mesh.material[i]));
    if (mesh.film.empty()) continue;
    const auto film = std::bit_cast<std::array<char, sizeof(float)>>(mesh.film[i].thickness_mm);
    out.append(film.data(), film.size());
  }
  for (const auto& t : mesh.triangles) {
    std::array<char, 13> f{};
    f[0] = 3;
    std::memcpy(f.data() + 1, t.data(), 12);
    out.append(f.data(), f.size());
  }
  return out;
}

}  // namespace enamel::twin
