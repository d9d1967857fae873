#include "host/mesh_files/stl.hpp"

#include <bit>
#include <cmath>
#include <unordered_map>

#include "host/mesh_files/mesh_check.hpp"
#include "host/mesh_files/text_scan.hpp"
#include "protocol/base/bytes.hpp"

namespace enamel::host {
namespace {

constexpr std::size_t kPreamble = 84;  ///< 80 bytes of anything, 4 of count
constexpr std::size_t kFacet = 50;

struct Position {
  std::array<std::uint32_t, 3> bits;
  friend bool operator==(const Position&, const Position&) = default;
};

struct PositionHash {
  std::size_t operator()(const Position& p) const noexcept {
    std::uint64_t h = p.bits[0];
    h = (h ^ (h >> 15U)) * 0x9e3779b97f4a7c15ULL + p.bits[1];
    h = (h ^ (h >> 29U)) * 0xbf58476d1ce4e5b9ULL + p.bits[2];
    return static_cast<std::size_t>((h ^ (h >> 31U)) * 0x94d049bb133111ebULL);
  }
};

/// Corners become vertices in order of first use.
class Welder {
 public:
  explicit Welder(Mesh& mesh) : mesh_(mesh) {}
  std::uint32_t vertex(const Vec3f& p) {
    const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f + 0.0F); };  // -0 becomes +0
    const Position key{{bits(p.x()), bits(p.y()), bits(p.z())}};
    const auto [at, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (is_new) {
      mesh_.vertices.push_back(p);
    }
    return at->second;
  }

 private:
  Mesh& mesh_;
  std::unordered_map<Position, std::uint32_t, PositionHash> index_;  // looked up only
};

Result<MeshFile> parse_binary(std::string_view bytes) {
  ByteReader reader(std::as_bytes(std::span(bytes.data(), bytes.size())));
  reader.skip(kPreamble - 4);
  const auto count = reader.get<std::uint32_t>();
  if (!reader.ok() || reader.remaining() < static_cast<std::uint64_t>(count) * kFacet) {
    return fail(ErrorCode::kMeshInvalid, "STL: truncated");
  }
  MeshFile out;
  Welder welder(out.mesh);
  out.mesh.triangles.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    reader.skip(12);
    std::array<std::uint32_t, 3> triangle{};
    for (std::uint32_t& corner : triangle) {
      const auto x = reader.get<float>();
      const auto y = reader.get<float>();
      const auto z = reader.get<float>();
      corner = welder.vertex(Vec3f(x, y, z));
    }
    reader.skip(2);
    out.mesh.triangles.push_back(triangle);
  }
  return out;
}

Result<MeshFile> parse_ascii(std::string_view text) {
  MeshFile out;
  Welder welder(out.mesh);
  std::string_view line;
  std::vector<std::uint32_t> corners;
  bool ended = false;
  for (std::size_t number = 1; next_line(text, line); ++number) {
    const std::string_view word = next_word(line);
    if (word == "vertex") {
      Vec3f p;
      for (int k = 0; k < 3; ++k) {
        const auto value = to_number<float>(next_word(line));
        if (!value) {
          return fail(ErrorCode::kMeshInvalid, "STL: line " + std::to_string(number) + " has no three numbers");
        }
        p[k] = *value;
      }
      corners.push_back(welder.vertex(p));
    } else if (word == "endfacet") {
      if (corners.size() != 3) {
        return fail(ErrorCode::kMeshInvalid,
                    "STL: the facet that ends in line " + std::to_string(number) + " is no triangle");
      }
      out.mesh.triangles.push_back({corners[0], corners[1], corners[2]});
      corners.clear();
    }
    ended = word == "endsolid" || (ended && word.empty());
  }
  if (!ended) {
    return fail(ErrorCode::kMeshInvalid, "STL: no endsolid: truncated");
  }
  return out;
}

}  // namespace

Result<MeshFile> parse_stl(std::string_view bytes) {
  // Many binary files also begin with "solid": the size decides.
  std::uint32_t count = 0;
  if (bytes.size() >= kPreamble) {
    std::memcpy(&count, bytes.data() + kPreamble - 4, sizeof count);
  }
  const bool fits = bytes.size() >= kPreamble && bytes.size() == kPreamble + static_cast<std::uint64_t>(count) * kFacet;
  auto out = !fits && bytes.substr(0, 5) == "solid" ? parse_ascii(bytes) : parse_binary(bytes);
  if (out) {
    ENAMEL_TRY(check_mesh(out->mesh, "STL"));
  }
  return out;
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
