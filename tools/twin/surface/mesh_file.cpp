#include "tools/twin/surface/mesh_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

#include "protocol/base/file.hpp"

namespace enamel::twin {
namespace {

static_assert(std::endian::native == std::endian::little, "binary mesh files are read by memcpy");

tl::unexpected<Error> bad_mesh(std::string why) { return fail(ErrorCode::kMeshInvalid, std::move(why)); }

Result<TriSurface> checked(TriSurface mesh) {
  if (mesh.triangles.empty()) return bad_mesh("no triangles");
  for (const auto& v : mesh.vertices) {
    if (!v.allFinite()) return bad_mesh("a vertex is not finite");
  }
  for (const auto& t : mesh.triangles) {
    for (const auto i : t) {
      if (i >= mesh.vertices.size())
        return bad_mesh("a face names vertex " + std::to_string(i) + " of " + std::to_string(mesh.vertices.size()));
    }
  }
  return mesh;
}

void add_fan(TriSurface& mesh, const std::vector<std::uint32_t>& corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

bool next_line(const std::string& text, std::size_t& at, std::string& line) {
  if (at >= text.size()) return false;
  const std::size_t end = std::min(text.find('\n', at), text.size());
  line = text.substr(at, end - at);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  at = end + 1;
  return true;
}

/// Merges equal coordinates.
class VertexMerger {
 public:
  explicit VertexMerger(TriSurface& mesh) : mesh_(mesh) {}
  std::uint32_t add(const Vec3f& v) {
    const std::array<float, 3> key{v.x(), v.y(), v.z()};
    const auto [it, fresh] = index_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (fresh) mesh_.vertices.push_back(v);
    return it->second;
  }

 private:
  TriSurface& mesh_;
  std::map<std::array<float, 3>, std::uint32_t> index_;
};

Result<TriSurface> parse_ascii_stl(const std::string& bytes) {
  TriSurface mesh;
  VertexMerger merger(mesh);
  std::vector<std::uint32_t> corners;
  std::size_t at = 0;
  std::string line, word;
  while (next_line(bytes, at, line)) {
    std::istringstream in(line);
    if (!(in >> word)) continue;
    if (word == "vertex") {
      Vec3f v;
      if (!(in >> v.x() >> v.y() >> v.z())) return bad_mesh("STL vertex is not three numbers: " + line);
      if (!v.allFinite()) return bad_mesh("a vertex is not finite");
      corners.push_back(merger.add(v));
    } else if (word == "endfacet") {
      if (corners.size() != 3) return bad_mesh("STL facet without three vertices");
      add_fan(mesh, corners);
      corners.clear();
    }
  }
  return checked(std::move(mesh));
}

}  // namespace

Result<TriSurface> parse_stl(const std::string& bytes) {
  constexpr std::size_t kHeader = 84, kFacet = 50;
  std::uint32_t count = 0;
  if (bytes.size() >= kHeader) std::memcpy(&count, bytes.data() + 80, 4);
  if (bytes.size() != kHeader + kFacet * std::size_t{count}) {
    if (bytes.rfind("solid", 0) == 0) return parse_ascii_stl(bytes);
    return bad_mesh("STL length does not fit its number of facets");
  }
  TriSurface mesh;
  VertexMerger merger(mesh);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 9> f{};
    std::memcpy(f.data(), bytes.data() + kHeader + kFacet * i + 12, sizeof f);
    std::array<std::uint32_t, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f v(f[3 * k], f[3 * k + 1], f[3 * k + 2]);
      if (!v.allFinite()) return bad_mesh("a vertex is not finite");
      t[k] = merger.add(v);
    }
    mesh.triangles.push_back(t);
  }
  return checked(std::move(mesh));
}

Result<TriSurface> parse_obj(const std::string& bytes) {
  TriSurface mesh;
  std::size_t at = 0;
  std::string line, word;
  while (next_line(bytes, at, line)) {
    std::istringstream in(line);
    if (!(in >> word)) continue;
    if (word == "v") {
      Vec3f v;
      if (!(in >> v.x() >> v.y() >> v.z())) return bad_mesh("OBJ vertex is not three numbers: " + line);
      mesh.vertices.push_back(v);
    } else if (word == "f") {
      std::vector<std::uint32_t> corners;
      while (in >> word) {
        long i = 0;
        const auto parsed = std::from_chars(word.data(), word.data() + word.size(), i);
        if (parsed.ec != std::errc{} || i == 0) return bad_mesh("OBJ face is not understood: " + line);
        const long n = static_cast<long>(mesh.vertices.size());
        const long index = i > 0 ? i - 1 : n + i;
        if (index < 0 || index > 0x7FFFFFFFL) return bad_mesh("OBJ face is out of range: " + line);
        corners.push_back(static_cast<std::uint32_t>(index));
      }
      if (corners.size() < 3) return bad_mesh("OBJ face with fewer than three corners: " + line);
      add_fan(mesh, corners);
    }
  }
  return checked(std::move(mesh));
}

Result<TriSurface> load_mesh(const std::string& path, float albedo) {
  ENAMEL_TRY_ASSIGN(const std::string bytes, read_file(path));
  std::string ext = std::filesystem::path(path).extension().string();
  std::transform(ext.begin(), ext.end(), ext.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  auto mesh = ext == ".ply"   ? parse_ply(bytes)
              : ext == ".stl" ? parse_stl(bytes)
              : ext == ".obj" ? parse_obj(bytes)
                              : Result<TriSurface>(bad_mesh("unknown extension '" + ext + "'"));
  if (!mesh) return fail(mesh.error().code, path + ": " + mesh.error().detail);
  mesh->albedo.assign(mesh->vertices.size(), albedo);
  compute_normals(*mesh);
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
