#include "tools/twin/jaw/polygonise.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace enamel::twin {
namespace {

constexpr int kCells = 8;  // cells along a block's edge
constexpr int kNodes = kCells + 1;
constexpr int kSuper = 4;     // blocks along a super-block's edge
constexpr double kFar = 1e6;  // stands for "no surface here"
constexpr std::uint32_t kNone = 0xFFFFFFFFU;
using Eigen::Vector3d;
using Field = std::function<double(const Vector3d&)>;
using Keep = std::function<bool(const Vector3d&)>;

struct Block {
  int x, y, z;
  std::vector<Vector3d> points;       // one a crossed cell
  std::vector<std::uint32_t> vertex;  // cell -> index into points, later into the whole mesh
  std::vector<std::uint8_t> inside;   // node signs
  std::uint32_t first = 0;
};

class Polygoniser {
 public:
  Polygoniser(const PolygoniseConfig& config, const Field& field, const Keep& keep)
      : config_(config), field_(field), keep_(keep), block_mm_(config.cell_mm * kCells) {
    const Vector3d size = (config.high - config.low) / block_mm_;
    for (int i = 0; i < 3; ++i) blocks_[static_cast<std::size_t>(i)] = static_cast<int>(std::ceil(size[i])) + 1;
  }

  TriSurface run() {
    find_blocks();
    tbb::parallel_for(std::size_t{0}, active_.size(), [&](std::size_t i) { mesh_block(active_[i]); });
    number_vertices();
    connect();
    smooth_folds(out_);
    return std::move(out_);
  }

 private:
  [[nodiscard]] bool near(const Vector3d& centre, double edge_mm) const {
    const double half_diagonal = 0.5 * std::sqrt(3.0) * edge_mm;
    return std::abs(field_(centre)) <= config_.lipschitz * half_diagonal;
  }

  void find_blocks() {
    const int sx = (blocks_[0] + kSuper - 1) / kSuper, sy = (blocks_[1] + kSuper - 1) / kSuper;
    const int sz = (blocks_[2] + kSuper - 1) / kSuper;
    std::vector<std::vector<Block>> found(static_cast<std::size_t>(sx) * static_cast<std::size_t>(sy));
    tbb::parallel_for(0, sx * sy, [&](int column) {
      for (int z = 0; z < sz; ++z) {
        const int x = column % sx, y = column / sx;
        const double edge = block_mm_ * kSuper;
        if (!near(config_.low + edge * Vector3d(x + 0.5, y + 0.5, z + 0.5), edge)) continue;
        search_super(x, y, z, found[static_cast<std::size_t>(column)]);
      }
    });
    for (auto& column : found) {
      for (auto& b : column) active_.push_back(std::move(b));
    }
    lookup_.assign(static_cast<std::size_t>(blocks_[0]) * static_cast<std::size_t>(blocks_[1]) *
                       static_cast<std::size_t>(blocks_[2]),
                   kNone);
    for (std::size_t i = 0; i < active_.size(); ++i) {
      lookup_[slot(active_[i].x, active_[i].y, active_[i].z)] = static_cast<std::uint32_t>(i);
    }
  }

  void search_super(int sx, int sy, int sz, std::vector<Block>& found) const {
    for (int z = sz * kSuper; z < std::min((sz + 1) * kSuper, blocks_[2]); ++z) {
      for (int y = sy * kSuper; y < std::min((sy + 1) * kSuper, blocks_[1]); ++y) {
        for (int x = sx * kSuper; x < std::min((sx + 1) * kSuper, blocks_[0]); ++x) {
          const Vector3d centre = config_.low + block_mm_ * Vector3d(x + 0.5, y + 0.5, z + 0.5);
          if (near(centre, block_mm_)) found.push_back({x, y, z, {}, {}, {}, 0});
        }
      }
    }
  }

  [[nodiscard]] std::size_t slot(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(blocks_[0]) +
           static_cast<std::size_t>(x);
  }
  static std::size_t node(int x, int y, int z) { return index(x, y, z, kNodes); }
  static std::size_t cell(int x, int y, int z) { return index(x, y, z, kCells); }
  static std::size_t index(int x, int y, int z, int n) {
    const int i = (z * n + y) * n + x;
    return static_cast<std::size_t>(i);
  }
  [[nodiscard]] Vector3d position(const Block& b, int x, int y, int z) const {
    return config_.low + config_.cell_mm * Vector3d(b.x * kCells + x, b.y * kCells + y, b.z * kCells + z);
  }

  using Values = std::array<double, static_cast<std::size_t>(kNodes) * kNodes * kNodes>;

  /// Values at the nodes of the cube of `size` cells at (x, y, z): exact where the surface may pass, elsewhere the
  /// value at a cube's centre, of which only the sign is used.
  void fill(const Block& b, int x, int y, int z, int size, Values& value) const {
    const double half = 0.5 * size;
    const Vector3d corner = position(b, x, y, z);
    const double centre = field_(corner + config_.cell_mm * Vector3d(half, half, half));
    const bool far = std::abs(centre) > config_.lipschitz * half * config_.cell_mm * std::sqrt(3.0);
    if (!far && size > 2) {
      const int h = size / 2;
      for (int i = 0; i < 8; ++i) fill(b, x + h * (i & 1), y + h * ((i >> 1) & 1), z + h * (i >> 2), h, value);
      return;
    }
    for (int k = 0; k <= size; ++k) {
      for (int j = 0; j <= size; ++j) {
        for (int i = 0; i <= size; ++i) {
          double& v = value[node(x + i, y + j, z + k)];
          if (far && std::isnan(v)) v = std::copysign(kFar, centre);
          if (!far && !(std::abs(v) < kFar)) v = field_(position(b, x + i, y + j, z + k));
        }
      }
    }
  }

  void mesh_block(Block& b) const {
    Values value;
    value.fill(std::numeric_limits<double>::quiet_NaN());
    fill(b, 0, 0, 0, kCells, value);
    b.inside.resize(value.size());
    for (std::size_t i = 0; i < value.size(); ++i) b.inside[i] = value[i] < 0 ? 1 : 0;
    b.vertex.assign(std::size_t{kCells} * kCells * kCells, kNone);
    if (std::equal(b.inside.begin() + 1, b.inside.end(), b.inside.begin())) return;
    for (int z = 0; z < kCells; ++z) {
      for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
          Vector3d p;
          if (!crossed(b, x, y, z) || !cell_point(b, value, x, y, z, p)) continue;
          settle(p, cell_gradient(value, x, y, z));
          if (!keep_(p)) continue;
          b.vertex[cell(x, y, z)] = static_cast<std::uint32_t>(b.points.size());
          b.points.push_back(p);
        }
      }
    }
  }

  static bool crossed(const Block& b, int x, int y, int z) {
    int sum = 0;
    for (int i = 0; i < 8; ++i) sum += b.inside[node(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2))];
    return sum != 0 && sum != 8;
  }

  /// Mean of the crossings on the cell's twelve edges.
  bool cell_point(const Block& b, const Values& value, int x, int y, int z, Vector3d& p) const {
    Vector3d sum = Vector3d::Zero();
    int crossings = 0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int k = 0; k < 4; ++k) {
        std::array<int, 3> a{x, y, z};
        a[static_cast<std::size_t>((axis + 1) % 3)] += k % 2;
        a[static_cast<std::size_t>((axis + 2) % 3)] += k / 2;
        std::array<int, 3> e = a;
        ++e[static_cast<std::size_t>(axis)];
        const double va = value[node(a[0], a[1], a[2])], ve = value[node(e[0], e[1], e[2])];
        if ((va < 0) == (ve < 0)) continue;
        Vector3d at(a[0], a[1], a[2]);
        at[axis] += va / (va - ve);
        sum += at;
        ++crossings;
      }
    }
    if (crossings == 0) return false;
    p = position(b, 0, 0, 0) + config_.cell_mm * (sum / crossings);
    return true;
  }

  [[nodiscard]] Vector3d cell_gradient(const Values& value, int x, int y, int z) const {
    Vector3d g = Vector3d::Zero();
    for (int i = 0; i < 8; ++i) {
      const double v = value[node(x + (i & 1), y + ((i >> 1) & 1), z + (i >> 2))];
      for (int axis = 0; axis < 3; ++axis) g[axis] += ((i >> axis) & 1) != 0 ? v : -v;
    }
    return g / (4.0 * config_.cell_mm);
  }

  /// One Newton step onto the surface, limited so that a vertex stays about its cell.
  void settle(Vector3d& p, const Vector3d& g) const {
    const double g2 = g.squaredNorm();
    if (g2 < 1e-6) return;
    Vector3d step = -field_(p) / g2 * g;
    const double limit = 0.35 * config_.cell_mm, length = step.norm();
    if (length > limit) step *= limit / length;
    p += step;
  }

  void number_vertices() {
    std::uint32_t count = 0;
    for (auto& b : active_) {
      b.first = count;
      count += static_cast<std::uint32_t>(b.points.size());
    }
    out_.vertices.resize(count);
    out_.albedo.assign(count, 0.8F);
    tbb::parallel_for(std::size_t{0}, active_.size(), [&](std::size_t i) {
      const Block& b = active_[i];
      for (std::size_t k = 0; k < b.points.size(); ++k) {
        out_.vertices[b.first + k] = b.points[k].cast<float>();
      }
    });
  }

  /// Mesh vertex of a cell that may lie in a neighbouring block.
  [[nodiscard]] std::uint32_t vertex_at(int gx, int gy, int gz) const {
    if (gx < 0 || gy < 0 || gz < 0) return kNone;
    const int bx = gx / kCells, by = gy / kCells, bz = gz / kCells;
    if (bx >= blocks_[0] || by >= blocks_[1] || bz >= blocks_[2]) return kNone;
    const std::uint32_t i = lookup_[slot(bx, by, bz)];
    if (i == kNone) return kNone;
    const Block& b = active_[i];
    const std::uint32_t v = b.vertex[cell(gx % kCells, gy % kCells, gz % kCells)];
    return v == kNone ? kNone : b.first + v;
  }

  void connect() {
    std::vector<std::vector<std::array<std::uint32_t, 3>>> parts(active_.size());
    tbb::parallel_for(std::size_t{0}, active_.size(), [&](std::size_t i) { connect_block(active_[i], parts[i]); });
    for (const auto& part : parts) out_.triangles.insert(out_.triangles.end(), part.begin(), part.end());
  }

  /// A quad for every grid edge of this block that the surface crosses, between the four cells about it.
  void connect_block(const Block& b, std::vector<std::array<std::uint32_t, 3>>& out) const {
    for (int z = 0; z < kCells; ++z) {
      for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) {
          for (std::size_t axis = 0; axis < 3; ++axis) {
            std::array<int, 3> e{x, y, z};
            ++e[axis];
            const bool in = b.inside[node(x, y, z)] != 0;
            if (in == (b.inside[node(e[0], e[1], e[2])] != 0)) continue;
            add_quad({b.x * kCells + x, b.y * kCells + y, b.z * kCells + z}, axis, in, out);
          }
        }
      }
    }
  }

  void add_quad(const std::array<int, 3>& g, std::size_t axis, bool inside,
                std::vector<std::array<std::uint32_t, 3>>& out) const {
    const std::size_t p = (axis + 1) % 3, q = (axis + 2) % 3;
    std::array<std::uint32_t, 4> v{};
    constexpr std::array<std::array<int, 2>, 4> kAround{{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};
    for (std::size_t k = 0; k < 4; ++k) {
      std::array<int, 3> c = g;
      c[p] += kAround[k][0];
      c[q] += kAround[k][1];
      v[k] = vertex_at(c[0], c[1], c[2]);
      if (v[k] == kNone) return;
    }
    if (!inside) std::swap(v[1], v[3]);
    const auto length2 = [&](std::size_t a, std::size_t c) {
      return (out_.vertices[v[a]] - out_.vertices[v[c]]).squaredNorm();
    };
    if (length2(0, 2) <= length2(1, 3)) {
      out.push_back({v[0], v[1], v[2]});
      out.push_back({v[0], v[2], v[3]});
    } else {
      out.push_back({v[0], v[1], v[3]});
      out.push_back({v[1], v[2], v[3]});
    }
  }

  PolygoniseConfig config_;
  const Field& field_;
  const Keep& keep_;
  double block_mm_;
  std::array<int, 3> blocks_{};
  std::vector<Block> active_;
  std::vector<std::uint32_t> lookup_;
  TriSurface out_;
};

}  // namespace

TriSurface polygonise(const PolygoniseConfig& config, const std::function<double(const Eigen::Vector3d&)>& field,
                      const std::function<bool(const Eigen::Vector3d&)>& keep) {
  return Polygoniser(config, field, keep).run();
}

}  // namespace enamel::twin
