#include "host/mesh_files/mesh_file.hpp"

#include <utility>

#include "host/mesh_files/obj.hpp"
#include "host/mesh_files/ply_read.hpp"
#include "host/mesh_files/stl.hpp"
#include "protocol/base/bytes.hpp"
#include "protocol/base/file.hpp"

namespace enamel::host {

std::string left_out_text(const LeftOut& left_out) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* one, const char* many, const char* what) {
    if (count > 0) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + (count == 1 ? one : many) + " " + what;
    }
  };
  add(left_out.unused_vertices, "vertex", "vertices", "that no face uses");
  add(left_out.broken_vertices, "vertex", "vertices", "without a finite position");
  add(left_out.broken_faces, "face", "faces", "with such a corner");
  add(left_out.flat_faces, "face", "faces", "without area");
  add(left_out.synthetic_faces, "face", "faces", "made up, not measured");
  if (left_out.normals) {
    text += std::string(text.empty() ? "" : ", ") + "normals (some are not finite)";
  }
  return text;
}

Result<MeshFormat> mesh_format(const std::string& path) {
  const std::size_t dot = path.find_last_of('.');
  std::string extension = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : extension) {
    c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (extension == ".ply") {
    return MeshFormat::kPly;
  }
  if (extension == ".stl") {
    return MeshFormat::kStl;
  }
  if (extension == ".obj") {
    return MeshFormat::kObj;
  }
  return fail(ErrorCode::kMeshInvalid, path + ": the extension is not .ply, .stl or .obj");
}

Result<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format) {
  switch (format) {
    case MeshFormat::kPly:
      return parse_ply(bytes);
    case MeshFormat::kStl:
      return parse_stl(bytes);
    case MeshFormat::kObj:
      return parse_obj(bytes);
  }
  return fail(ErrorCode::kInternal, "mesh format");
}

Result<MeshFile> read_mesh(const std::string& path) {
  ENAMEL_TRY_ASSIGN(const MeshFormat format, mesh_format(path));
  ENAMEL_TRY_ASSIGN(const std::string bytes, read_file(path));
  auto mesh = parse_mesh(bytes, format);
  if (!mesh) {
    mesh.error().detail = path + ": " + mesh.error().detail;
  }
  return mesh;
}

Result<MeshFile> read_measured_mesh(const std::string& path) {
  ENAMEL_TRY_ASSIGN(auto file, read_mesh(path));
  auto measured = leave_out_synthetic(std::move(file));
  if (!measured) {
    measured.error().detail = path + ": " + measured.error().detail;
  }
  return measured;
}

std::string ply_bytes(const Mesh& mesh, const VertexColours& colours, const Vec3d& origin_mm) {
  const bool moved = !origin_mm.isZero(0);
  const bool normals = mesh.normals.size() == mesh.vertices.size() && !mesh.normals.empty();
  const bool quality = mesh.quality.size() == mesh.vertices.size() && !mesh.quality.empty();
  const bool coloured = colours.size() == mesh.vertices.size() && !colours.empty();
  std::string header = "ply\nformat binary_little_endian 1.0\ncomment enamel, mm\nelement vertex " +
                       std::to_string(mesh.vertices.size()) +
                       (moved ? "\nproperty double x\nproperty double y\nproperty double z\n"
                              : "\nproperty float x\nproperty float y\nproperty float z\n");
  header += normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "";
  header += quality ? "property float quality\n" : "";
  const bool soft = mesh.soft.size() == mesh.vertices.size() && !mesh.soft.empty();
  header += soft ? "property uchar soft_tissue\n" : "";
  header += coloured ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "";
  header += "element face " + std::to_string(mesh.triangles.size()) +
            "\nproperty list uchar int vertex_indices\nend_header\n";
  ByteWriter writer;
  writer.put_text(header);
  const auto put = [&](const auto& v) {
    writer.put(v.x());
    writer.put(v.y());
    writer.put(v.z());
  };
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    moved ? put(Vec3d(mesh.vertices[i].cast<double>() + origin_mm)) : put(mesh.vertices[i]);
    if (normals) {
      put(mesh.normals[i]);
    }
    if (quality) {
      writer.put(mesh.quality[i]);
    }
    if (soft) {
      writer.put(mesh.soft[i]);
    }
    for (const std::uint8_t c : coloured ? colours[i] : std::array<std::uint8_t, 3>{}) {
      if (coloured) {
        writer.put(c);
      }
    }
  }
  for (const auto& t : mesh.triangles) {
    writer.put(std::uint8_t{3});
    for (const std::uint32_t corner : t) {
      writer.put(static_cast<std::int32_t>(corner));
    }
  }
  const auto bytes = writer.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<void> write_mesh(const std::string& path, const Mesh& mesh) {
  ENAMEL_TRY_ASSIGN(const MeshFormat format, mesh_format(path));
  switch (format) {
    case MeshFormat::kPly:
      return write_file(path, ply_bytes(mesh));
    case MeshFormat::kStl:
      return write_file(path, stl_bytes(mesh));
    case MeshFormat::kObj:
      return write_file(path, obj_text(mesh));
  }
  return fail(ErrorCode::kInternal, "mesh format");
}

}  // namespace enamel::host
