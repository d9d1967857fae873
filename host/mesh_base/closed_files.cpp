#include <fmt/format.h>

#include <iterator>
#include <string>

#include "host/mesh_base/close_base.hpp"
#include "host/mesh_files/mesh_file.hpp"
#include "protocol/base/bytes.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {

std::string closed_ply(const ClosedMesh& closed) {
  const Mesh& mesh = closed.mesh;
  ByteWriter writer;
  writer.put_text(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment enamel, mm; synthetic 1: made up, not measured\n"
                  "element vertex {}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar synthetic\n"
                  "element face {}\nproperty list uchar int vertex_indices\nproperty uchar synthetic\nend_header\n",
                  mesh.vertices.size(), mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) writer.put(mesh.vertices[i][axis]);
    writer.put(std::uint8_t{i < closed.measured_vertices ? std::uint8_t{0} : std::uint8_t{1}});
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    writer.put(std::uint8_t{3});
    for (const std::uint32_t corner : mesh.triangles[f]) writer.put(static_cast<std::int32_t>(corner));
    writer.put(std::uint8_t{f < closed.measured_faces ? std::uint8_t{0} : std::uint8_t{1}});
  }
  const auto bytes = writer.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string closed_obj(const ClosedMesh& closed) {
  std::string text = "# enamel, mm; group synthetic: made up, not measured\n";
  auto to = std::back_inserter(text);
  for (const Vec3f& v : closed.mesh.vertices) fmt::format_to(to, "v {} {} {}\n", v.x(), v.y(), v.z());
  for (std::size_t f = 0; f < closed.mesh.triangles.size(); ++f) {
    if (f == 0) text += "g measured\n";
    if (f == closed.measured_faces) text += "g synthetic\n";
    const auto& t = closed.mesh.triangles[f];
    fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  }
  return text;
}

std::string closed_stl(const ClosedMesh& closed) {
  constexpr std::size_t kHeader = 80;
  std::string bytes = stl_bytes(closed.mesh);
  std::string header = fmt::format("enamel binary STL, mm; facets from {} on are synthetic", closed.measured_faces);
  header.resize(kHeader, ' ');
  return bytes.replace(0, kHeader, header);
}

Result<void> write_closed(const std::string& path, const ClosedMesh& closed) {
  ENAMEL_TRY_ASSIGN(const MeshFormat format, mesh_format(path));
  switch (format) {
    case MeshFormat::kPly:
      return write_file(path, closed_ply(closed));
    case MeshFormat::kStl:
      return write_file(path, closed_stl(closed));
    case MeshFormat::kObj:
      return write_file(path, closed_obj(closed));
  }
  return fail(ErrorCode::kInternal, "mesh format");
}

}  // namespace enamel::host
