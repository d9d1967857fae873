#include "host/mesh_files/stl.hpp"

#include <bit>
#include <unordered_map>

#include "host/mesh_files/mesh_soup.hpp"
#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/bytes.hpp"
#include "protocol/base/plain_text.hpp"

namespace enamel::host {
namespace {

constexpr std::size_t kPreamble = 84;  ///< 80 bytes of anything, 4 of count
constexpr std::size_t kFacetBytes = 50;
constexpr std::uint32_t kNotCounted = 0xffffffff;

struct Position {
  std::array<std::uint64_t, 3> bits;
  friend bool operator==(const Position&, const Position&) = default;
};

struct PositionHash {
  std::size_t operator()(const Position& p) const noexcept {
    std::uint64_t h = p.bits[0];
    h = (h ^ (h >> 31U)) * 0x9e3779b97f4a7c15ULL + p.bits[1];
    h = (h ^ (h >> 29U)) * 0xbf58476d1ce4e5b9ULL + p.bits[2];
    return static_cast<std::size_t>((h ^ (h >> 31U)) * 0x94d049bb133111ebULL);
  }
};

/// Corners become vertices in order of first use.
class Welder {
 public:
  explicit Welder(MeshSoup& soup) : soup_(soup) {}
  std::uint32_t vertex(const Vec3d& p) {
    const auto bits = [](double f) { return std::bit_cast<std::uint64_t>(f + 0.0); };  // -0 becomes +0
    const Position key{{bits(p.x()), bits(p.y()), bits(p.z())}};
    const auto [at, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(soup_.positions.size()));
    if (is_new) {
      soup_.positions.push_back(p);
    }
    return at->second;
  }

 private:
  MeshSoup& soup_;
  std::unordered_map<Position, std::uint32_t, PositionHash> index_;  // looked up only
};

Result<MeshSoup> parse_binary(std::string_view bytes) {
  ByteReader reader(std::as_bytes(std::span(bytes.data(), bytes.size())));
  reader.skip(kPreamble - 4);
  auto count = reader.get<std::uint32_t>();
  // Written in one go, without going back to the count: the size tells.
  const bool open = count == 0 || count == kNotCounted;
  if (reader.ok() && open && reader.remaining() % kFacetBytes == 0 && reader.remaining() / kFacetBytes < kNotCounted)
    count = static_cast<std::uint32_t>(reader.remaining() / kFacetBytes);
  if (!reader.ok() || reader.remaining() < static_cast<std::uint64_t>(count) * kFacetBytes) {
    return fail(ErrorCode::kMeshInvalid, "STL: truncated");
  }
  MeshSoup out;
  out.floats = true;
  Welder welder(out);
  out.triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    reader.skip(12);
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      const auto x = reader.get<float>();
      const auto y = reader.get<float>();
      const auto z = reader.get<float>();
      corner = welder.vertex(Vec3f(x, y, z).cast<double>());
    }
    reader.skip(2);
    out.triangles.push_back(triangle);
  }
  return out;
}

/// No STL knows remarks; some programs write them all the same.
bool is_remark(std::string_view word) {
  return word.starts_with('#') || word.starts_with(';') || word.starts_with("//");
}

enum class Keyword { kSolid, kEndSolid, kFacet, kEndFacet, kVertex, kOther };

Keyword keyword_of(std::string_view word, Words& words) {
  if (same_letters(word, "end")) {  // "end facet"
    const std::string_view what = words.next();
    if (same_letters(what, "solid")) {
      return Keyword::kEndSolid;
    }
    return same_letters(what, "facet") ? Keyword::kEndFacet : Keyword::kOther;
  }
  constexpr std::array<std::pair<std::string_view, Keyword>, 5> kWords{{{"vertex", Keyword::kVertex},
                                                                        {"endfacet", Keyword::kEndFacet},
                                                                        {"facet", Keyword::kFacet},
                                                                        {"solid", Keyword::kSolid},
                                                                        {"endsolid", Keyword::kEndSolid}}};
  for (const auto& [name, keyword] : kWords) {
    if (same_letters(word, name)) {
      return keyword;
    }
  }
  return Keyword::kOther;  // normals, outer, loop, endloop, colours
}

Result<MeshSoup> parse_ascii(std::string_view text) {
  MeshSoup out;
  Welder welder(out);
  Words words(text);
  std::vector<std::uint32_t> corners;
  bool in_solid = false, in_facet = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    const Keyword keyword = keyword_of(word, words);
    if (keyword == Keyword::kSolid || keyword == Keyword::kEndSolid) {
      in_solid = keyword == Keyword::kSolid;
      words.skip_line();  // its name may hold anything
    } else if (keyword == Keyword::kVertex) {
      Vec3d p;
      for (int k = 0; k < 3; ++k) {
        const auto value = to_real(words.next());
        if (!value) {
          return fail(ErrorCode::kMeshInvalid, "STL: line " + std::to_string(words.line()) + " has no three numbers");
        }
        p[k] = *value;
      }
      corners.push_back(welder.vertex(p));
    } else if (is_remark(word)) {
      words.skip_line();
    } else if (keyword != Keyword::kOther) {
      if (in_facet) {
        out.add_face(corners);
      }
      corners.clear();
      in_facet = keyword == Keyword::kFacet;
      in_solid = in_solid || in_facet;
    }
  }
  if (in_solid) {
    return fail(ErrorCode::kMeshInvalid, "STL: no endsolid: truncated");
  }
  return out;
}

/// By what it says and not by its first five letters: headers of binary files may begin with "solid", texts with
/// blanks.
bool is_text(std::string_view text) {
  constexpr std::size_t kLooked = 1024;
  const std::string_view head = text.substr(0, kLooked);
  Words words(head);
  std::string_view word = words.next();
  for (; is_remark(word); word = words.next()) words.skip_line();
  return (same_letters(word, "solid") || same_letters(word, "facet")) && head.find('\0') == std::string_view::npos;
}

}  // namespace

Result<MeshFile> parse_stl(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kPreamble) {
    std::memcpy(&count, bytes.data() + kPreamble - 4, sizeof count);
  }
  const bool fits =
      bytes.size() >= kPreamble && bytes.size() == kPreamble + static_cast<std::uint64_t>(count) * kFacetBytes;
  std::string room;
  std::string_view text = fits ? std::string_view{} : plain_text(bytes, room);
  text = text.substr(0, text.find_last_not_of('\0') + 1);  // some systems fill up the last block
  ENAMEL_TRY_ASSIGN(MeshSoup soup, is_text(text) ? parse_ascii(text) : parse_binary(bytes));
  return finish_mesh(std::move(soup), "STL");
}

std::string stl_bytes(const Mesh& mesh) {
  std::string header = "enamel binary STL, mm";
  header.resize(kPreamble - 4, ' ');
  ByteWriter writer;
  writer.put_text(header);
  writer.put(static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Vec3f& a = mesh.vertices[t[0]];
    const Vec3f& b = mesh.vertices[t[1]];
    const Vec3f& c = mesh.vertices[t[2]];
    Vec3f n = (b - a).cross(c - a);
    const float length = n.norm();
    n = length > 0.0F ? Vec3f(n / length) : Vec3f(0.0F, 0.0F, 0.0F);
    for (const Vec3f* v : {&static_cast<const Vec3f&>(n), &a, &b, &c}) {
      writer.put(v->x());
      writer.put(v->y());
      writer.put(v->z());
    }
    writer.put(std::uint16_t{0});
  }
  const auto bytes = writer.bytes();
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace enamel::host
