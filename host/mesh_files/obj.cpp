#include "host/mesh_files/obj.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>
#include <optional>
#include <utility>

#include "host/mesh_files/mesh_soup.hpp"
#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

tl::unexpected<Error> bad_obj(std::size_t line, const char* reason) {
  return fail(ErrorCode::kMeshInvalid, "OBJ line " + std::to_string(line) + ": " + reason);
}

std::optional<Vec3d> vector_of(std::string_view line) {
  Vec3d v;
  for (int k = 0; k < 3; ++k) {
    const auto value = to_real(next_word(line));
    if (!value) {
      return std::nullopt;
    }
    v[k] = *value;
  }
  return v;
}

/// From 0; counted from 1 in the file, negative from the end of what it has so far. Positive ones may lie ahead.
std::optional<std::uint32_t> index_of(std::string_view word, std::size_t so_far) {
  constexpr std::int64_t kMost = 0xFFFFFFFE;
  const auto number = to_number<std::int64_t>(word);
  if (!number || *number == 0 || *number > kMost) {
    return std::nullopt;
  }
  const std::int64_t index = *number > 0 ? *number - 1 : static_cast<std::int64_t>(so_far) + *number;
  return index < 0 ? std::nullopt : std::optional(static_cast<std::uint32_t>(index));
}

bool continues(std::string_view line) {
  while (!line.empty() && is_space(line.back())) {
    line.remove_suffix(1);
  }
  return line.ends_with('\\');
}

/// A # inside a word (1.#QNAN) begins none.
std::string_view without_comment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
    if (at == 0 || is_space(line[at - 1])) {
      return line.substr(0, at);
    }
  }
  return line;
}

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : text_(text) {}

  Result<MeshSoup> read() {
    std::string_view line;
    while (next_line(text_, line)) {
      ++number_;
      std::string_view rest = line;
      const std::string_view word = next_word(rest);
      const std::size_t first = number_;  // of the lines that a backslash joins
      if (word == "v" || word == "vn") {
        const auto v = vector_of(statement(rest));
        if (!v) {
          return bad_obj(first, "no three numbers");
        }
        word == "v" ? soup_.positions.push_back(*v) : soup_.normals.push_back(v->cast<float>());
      } else if (word == "f" && !face(statement(rest), first)) {
        return bad_obj(first, "names a vertex that does not exist");
      } else if (word == "g") {
        soup_.tag_synthetic(made_up_);
        made_up_ = next_word(rest) == "synthetic";
      }
    }
    soup_.tag_synthetic(made_up_);
    if (farthest_ >= soup_.positions.size() && farthest_line_ > 0) {
      return bad_obj(farthest_line_, "names a vertex that does not exist");
    }
    if (!normals_match_ || soup_.normals.size() != soup_.positions.size()) {
      soup_.normals.clear();
    }
    return std::move(soup_);
  }

 private:
  /// The rest of a line without its comment, with the lines that a backslash at its end joins to it.
  std::string_view statement(std::string_view line) {
    line = without_comment(line);
    if (!continues(line)) {
      return line;
    }
    joined_.clear();
    for (bool more = true; more;) {
      more = continues(line);
      joined_.append(more ? line.substr(0, line.find_last_of('\\')) : line).push_back(' ');
      more = more && next_line(text_, line);
      number_ += more ? 1U : 0U;
      line = without_comment(line);
    }
    return joined_;
  }

  /// Corners as v, v/vt, v//vn, v/vt/vn.
  bool face(std::string_view words, std::size_t line) {
    corners_.clear();
    for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
      const std::size_t slash = word.find('/'), last = word.rfind('/');
      const auto corner = index_of(word.substr(0, slash), soup_.positions.size());
      if (!corner) {
        return false;
      }
      const bool has_normal = last != slash;
      normals_match_ = normals_match_ && has_normal && index_of(word.substr(last + 1), soup_.normals.size()) == corner;
      if (farthest_line_ == 0 || *corner > farthest_) {
        farthest_ = *corner;
        farthest_line_ = line;
      }
      corners_.push_back(*corner);
    }
    soup_.add_face(corners_);
    return true;
  }

  std::string_view text_;
  std::size_t number_ = 0;
  std::string joined_;
  MeshSoup soup_;
  std::vector<std::uint32_t> corners_;
  std::size_t farthest_ = 0, farthest_line_ = 0;  ///< largest index that a face names
  bool made_up_ = false;                          ///< the group that faces are in now is called synthetic
  bool normals_match_ = true;                     ///< every corner names the normal of its own index
};

}  // namespace

Result<MeshFile> parse_obj(std::string_view bytes) {
  std::string room;
  ENAMEL_TRY_ASSIGN(MeshSoup soup, ObjReader(plain_text(bytes, room)).read());
  return finish_mesh(std::move(soup), "OBJ");
}

namespace {

constexpr const char* kHardGroup = "g hard\n";
constexpr const char* kSoftGroup = "g soft_tissue\n";

/// Most of the corners decide. No groups where nothing is soft.
const char* group_of(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  if (mesh.soft.empty()) return "";
  return mesh.soft[t[0]] + mesh.soft[t[1]] + mesh.soft[t[2]] >= 2 ? kSoftGroup : kHardGroup;
}

}  // namespace

std::string obj_text(const Mesh& mesh) {
  std::string text = "# enamel, mm\n";
  auto to = std::back_inserter(text);
  for (const Vec3f& v : mesh.vertices) {
    fmt::format_to(to, "v {} {} {}\n", v.x(), v.y(), v.z());
  }
  for (const Vec3f& n : mesh.normals) {
    fmt::format_to(to, "vn {} {} {}\n", n.x(), n.y(), n.z());
  }
  const char* group = "";
  for (const auto& t : mesh.triangles) {
    const char* own = group_of(mesh, t);
    if (own != group) text += own;
    group = own;
    if (mesh.normals.empty()) {
      fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    } else {
      fmt::format_to(to, "f {0}//{0} {1}//{1} {2}//{2}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
  }
  return text;
}

}  // namespace enamel::host
