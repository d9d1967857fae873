#include "viewer/scene/coarse_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace enamel::view {
namespace {

constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
constexpr float kOnFaceMm = 1e-3F;  // chosen: beyond rounding, far below a voxel
constexpr std::size_t kOfACut = 3;  // chosen: border vertices in a plane; a surface's own extreme has one or two

std::uint64_t mixed(std::uint64_t x) noexcept {  // splitmix64
  x ^= x >> 30U;
  x *= 0xbf58476d1ce4e5b9U;
  x ^= x >> 27U;
  x *= 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

std::uint64_t hash_of(const Vec3f& p) noexcept {
  const auto bits = [](float v) { return std::uint64_t{std::bit_cast<std::uint32_t>(v + 0.0F)}; };  // -0 is 0
  return mixed(mixed(bits(p.x()) | bits(p.y()) << 32U) ^ bits(p.z()));
}

std::size_t table_size(std::size_t entries) { return std::bit_ceil(std::max<std::size_t>(2 * entries, 16)); }

/// How far from the middle of its cell; the grid's cells are centred on multiples of the cell.
float off_centre(const Vec3f& p, float cell_mm) {
  const Vec3f cells = p / cell_mm;
  return (cells - cells.array().round().matrix()).squaredNorm();
}

bool lower(const Vec3f& a, const Vec3f& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}  // namespace

void CoarseMesher::weld(std::span<const MeshPart> parts) {
  std::size_t count = 0;
  for (const MeshPart& part : parts) count += part.mesh->vertices.size();
  table_.assign(table_size(count), kFree);
  const std::size_t mask = table_.size() - 1;
  welded_.clear();
  vertices_.clear();
  lowest_.setConstant(std::numeric_limits<float>::max());
  highest_ = -lowest_;
  for (const MeshPart& part : parts) {
    for (std::size_t i = 0; i < part.mesh->vertices.size(); ++i) {
      const Vec3f& p = part.mesh->vertices[i];
      std::size_t at = hash_of(p) & mask;
      while (table_[at] != kFree && vertices_[table_[at]].position != p) at = (at + 1) & mask;
      if (table_[at] == kFree) {
        table_[at] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({p, part.base + static_cast<std::uint32_t>(i), 0, 0});
        lowest_ = lowest_.cwiseMin(p);
        highest_ = highest_.cwiseMax(p);
      }
      welded_.push_back(table_[at]);
    }
  }
}

/// Around a vertex inside the surface every neighbour follows in one triangle and leads in another: what they add
/// cancels.
void CoarseMesher::find_border(std::span<const MeshPart> parts) {
  std::size_t first = 0;
  for (const MeshPart& part : parts) {
    for (const IndexTriangle& t : part.mesh->triangles) {
      const std::array<std::int64_t, 3> w{welded_[first + t[0]], welded_[first + t[1]], welded_[first + t[2]]};
      for (std::size_t k = 0; k < 3; ++k) {
        vertices_[static_cast<std::size_t>(w[k])].turn += w[(k + 1) % 3] - w[(k + 2) % 3];
      }
    }
    first += part.mesh->vertices.size();
  }
  std::array<std::size_t, 6> on_side{};
  for (const Vertex& vertex : vertices_) {
    for (std::size_t side = 0; vertex.turn != 0 && side < 6; ++side) on_side[side] += touches(vertex, side) ? 1U : 0U;
  }
  for (std::size_t side = 0; side < 6; ++side) cut_[side] = on_side[side] >= kOfACut;
}

bool CoarseMesher::touches(const Vertex& vertex, std::size_t side) const {
  const auto axis = static_cast<Eigen::Index>(side / 2);
  const float p = vertex.position[axis];
  return side % 2 == 0 ? p <= lowest_[axis] + kOnFaceMm : p >= highest_[axis] - kOnFaceMm;
}

std::uint64_t CoarseMesher::cluster_key(const Vertex& vertex, float cell_mm) const {
  std::uint64_t key = vertex.turn != 0 ? 1U : 0U;
  // Each side where the part was cut off its neighbour by itself: there both have the same vertices.
  for (std::size_t side = 0; vertex.turn != 0 && side < 6; ++side)
    key = key << 1U | (cut_[side] && touches(vertex, side) ? 1U : 0U);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const auto cell = static_cast<std::int64_t>(std::round(vertex.position[k] / cell_mm));
    key = key << 18U | (static_cast<std::uint64_t>(cell) & 0x3ffffU);
  }
  return key;
}

void CoarseMesher::choose(float cell_mm) {
  table_.assign(table_size(vertices_.size()), kFree);
  keys_.resize(table_.size());
  const std::size_t mask = table_.size() - 1;
  for (Vertex& vertex : vertices_) {
    const std::uint64_t key = cluster_key(vertex, cell_mm);
    std::size_t at = mixed(key) & mask;
    while (table_[at] != kFree && keys_[at] != key) at = (at + 1) & mask;
    vertex.stands_for = static_cast<std::uint32_t>(at);
    const auto self = static_cast<std::uint32_t>(&vertex - vertices_.data());
    keys_[at] = key;
    if (table_[at] == kFree) {
      table_[at] = self;
      continue;
    }
    const Vertex& best = vertices_[table_[at]];
    const float mine = off_centre(vertex.position, cell_mm), its = off_centre(best.position, cell_mm);
    if (mine < its || (mine == its && lower(vertex.position, best.position))) table_[at] = self;
  }
}

std::vector<IndexTriangle> CoarseMesher::coarser(std::span<const MeshPart> parts, float cell_mm) {
  weld(parts);
  find_border(parts);
  choose(cell_mm);
  std::vector<IndexTriangle> out;
  std::size_t first = 0;
  for (const MeshPart& part : parts) {
    for (const IndexTriangle& t : part.mesh->triangles) {
      IndexTriangle r{};
      for (std::size_t k = 0; k < 3; ++k) r[k] = table_[vertices_[welded_[first + t[k]]].stands_for];
      if (r[0] != r[1] && r[1] != r[2] && r[2] != r[0])
        out.push_back({vertices_[r[0]].index, vertices_[r[1]].index, vertices_[r[2]].index});
    }
    first += part.mesh->vertices.size();
  }
  return out;
}

}  // namespace enamel::view
