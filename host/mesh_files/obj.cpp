#include "host/mesh_files/obj.hpp"

#include <fmt/format.h>

#include <iterator>
#include <optional>

#include "host/mesh_files/mesh_check.hpp"
#include "host/mesh_files/text_scan.hpp"

namespace enamel::host {
namespace {

tl::unexpected<Error> bad_obj(std::size_t line, const char* reason) {
  return fail(ErrorCode::kMeshInvalid, "OBJ line " + std::to_string(line) + ": " + reason);
}

std::optional<Vec3f> vector_of(std::string_view line) {
  Vec3f v;
  for (int k = 0; k < 3; ++k) {
    const auto value = to_number<float>(next_word(line));
    if (!value) {
      return std::nullopt;
    }
    v[k] = *value;
  }
  return v;
}

// First number of v, v/vt, v//vn, v/vt/vn; counted from 1, negative from the end.
std::optional<std::uint32_t> corner_of(std::string_view word, std::size_t vertices) {
  const auto number = to_number<std::int64_t>(word.substr(0, word.find('/')));
  if (!number) {
    return std::nullopt;
  }
  const auto count = static_cast<std::int64_t>(vertices);
  const std::int64_t index = *number > 0 ? *number - 1 : count + *number;
  if (*number == 0 || index < 0 || index >= count) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(index);
}

}  // namespace

Result<MeshFile> parse_obj(std::string_view text) {
  MeshFile out;
  std::string_view line;
  std::vector<std::uint32_t> corners;
  for (std::size_t number = 1; next_line(text, line); ++number) {
    const std::string_view word = next_word(line);
    if (word == "v" || word == "vn") {
      const auto v = vector_of(line);
      if (!v) {
        return bad_obj(number, "no three numbers");
      }
      (word == "v" ? out.mesh.vertices : out.mesh.normals).push_back(*v);
    } else if (word == "f") {
      corners.clear();
      for (std::string_view c = next_word(line); !c.empty(); c = next_word(line)) {
        const auto corner = corner_of(c, out.mesh.vertices.size());
        if (!corner) {
          return bad_obj(number, "names a vertex that does not exist");
        }
        corners.push_back(*corner);
      }
      if (corners.size() < 3) {
        return bad_obj(number, "a face with fewer than three corners");
      }
      for (std::size_t k = 2; k < corners.size(); ++k) {
        out.mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
      }
    }
  }
  if (out.mesh.normals.size() != out.mesh.vertices.size()) {
    out.mesh.normals.clear();
  }
  ENAMEL_TRY(check_mesh(out.mesh, "OBJ"));
  return out;
}

std::string obj_text(const Mesh& mesh) {
  std::string text = "# enamel, mm\n";
  auto to = std::back_inserter(text);
  for (const Vec3f& v : mesh.vertices) {
    fmt::format_to(to, "v {} {} {}\n", v.x(), v.y(), v.z());
  }
  for (const Vec3f& n : mesh.normals) {
    fmt::format_to(to, "vn {} {} {}\n", n.x(), n.y(), n.z());
  }
  for (const auto& t : mesh.triangles) {
    if (mesh.normals.empty()) {
      fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    } else {
      fmt::format_to(to, "f {0}//{0} {1}//{1} {2}//{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
  }
  return text;
}

}  // namespace enamel::host
