// Any bytes as PLY, STL or OBJ (the first byte chooses): the reader ends with a verdict, what it lets in is a mesh, and
// no count in the file makes more of it than the file has bytes for.
#include <cstdint>
#include <string>
#include <string_view>

#include "host/mesh_files/mesh_file.hpp"
#include "tests/fuzz/demand.hpp"

namespace {

using namespace enamel;
using test::demand;

void demand_mesh(const host::MeshFile& file, std::size_t bytes) {
  const Mesh& mesh = file.mesh;
  demand(!mesh.triangles.empty(), "an empty mesh is refused");
  demand(mesh.vertices.size() <= bytes && mesh.triangles.size() <= bytes, "every vertex and face cost a byte or more");
  demand(mesh.normals.empty() || mesh.normals.size() == mesh.vertices.size(), "one normal a vertex");
  demand(mesh.quality.empty() || mesh.quality.size() == mesh.vertices.size(), "one quality a vertex");
  for (const auto& [name, values] : file.vertex_values) {
    demand(values.size() == mesh.vertices.size(), "one value a vertex");
  }
  for (const Vec3f& v : mesh.vertices) demand(v.allFinite(), "positions are finite");
  for (const Vec3f& n : mesh.normals) demand(n.allFinite(), "normals are finite");
  demand(file.origin_mm.allFinite() && file.step_mm >= 0, "the origin is a place");
  for (const auto& t : mesh.triangles) {
    demand(t[0] < mesh.vertices.size() && t[1] < mesh.vertices.size() && t[2] < mesh.vertices.size(),
           "corners are vertices");
    demand(t[0] != t[1] && t[1] != t[2] && t[2] != t[0], "a triangle has three corners");
  }
}

/// What was let in once is let in again, as it is, where no origin has to be chosen.
void demand_round_trip(const Mesh& mesh) {
  constexpr float kNearMm = 1000;
  for (const Vec3f& v : mesh.vertices) {
    if (v.cwiseAbs().maxCoeff() > kNearMm) return;
  }
  const auto back = host::parse_mesh(host::ply_bytes(mesh), host::MeshFormat::kPly);
  demand(back && host::left_out_text(back->left_out).empty(), "it is sound");
  demand(back->mesh.vertices == mesh.vertices && back->mesh.triangles == mesh.triangles, "it is the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto format = static_cast<host::MeshFormat>(data[0] % 3);
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const auto file = host::parse_mesh(bytes, format);
  if (!file) {
    demand(file.error().code == ErrorCode::kMeshInvalid && !file.error().detail.empty(), "a refusal has its reason");
    return 0;
  }
  demand_mesh(*file, bytes.size());
  demand_round_trip(file->mesh);
  return 0;
}
