#include "tools/twin/surface/film.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/twin/optics/random.hpp"
#include "tools/twin/surface/noise.hpp"

namespace enamel::twin {
namespace {

constexpr double kCellMm = 0.15;     // of the height map: coarser than the mesh, so that hardly a cell is empty
constexpr double kMeniscusMm = 0.6;  // half the width that saliva bridges
constexpr double kNothingMm = 0.02;  // a pool less deep is roughness of the height map
constexpr float kNowhere = -1e9F;

double ramp(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Highest points over a grid in x and y.
class HeightMap {
 public:
  explicit HeightMap(const TriSurface& surface) {
    Vec3f low = surface.vertices.front(), high = low;
    for (const Vec3f& v : surface.vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    x0_ = static_cast<double>(low.x());
    y0_ = static_cast<double>(low.y());
    nx_ = static_cast<int>((static_cast<double>(high.x()) - x0_) / kCellMm) + 1;
    ny_ = static_cast<int>((static_cast<double>(high.y()) - y0_) / kCellMm) + 1;
    z_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_), kNowhere);
    for (const Vec3f& v : surface.vertices) {
      float& cell = z_[cell_of(static_cast<double>(v.x()), static_cast<double>(v.y()))];
      cell = std::max(cell, v.z());
    }
    constexpr int kFillReach = 1;
    const std::vector<float> wider = extreme(z_, kFillReach, true);
    for (std::size_t i = 0; i < z_.size(); ++i) {
      if (z_[i] == kNowhere) z_[i] = wider[i];
    }
  }

  /// How deep liquid stands: up to the level that bridges what is narrower than the meniscus, at most `most_mm` above
  /// the lowest place within its reach (morphological closing, flat disc).
  [[nodiscard]] std::vector<float> pools(double most_mm) const {
    const int reach = static_cast<int>(std::lround(kMeniscusMm / kCellMm));
    const std::vector<float> closed = extreme(extreme(z_, reach, true), reach, false);
    const std::vector<float> bottom = extreme(z_, reach, false);
    std::vector<float> depth(z_.size(), 0);
    for (std::size_t i = 0; i < z_.size(); ++i) {
      if (z_[i] == kNowhere) continue;
      depth[i] = std::max(0.0F, std::min(closed[i], bottom[i] + static_cast<float>(most_mm)) - z_[i]);
    }
    return depth;
  }

  /// Of a map at a place, between cells' middles.
  [[nodiscard]] double at(const std::vector<float>& map, double x, double y) const {
    const double fx = std::clamp((x - x0_) / kCellMm - 0.5, 0.0, std::max(0.0, nx_ - 1.001));
    const double fy = std::clamp((y - y0_) / kCellMm - 0.5, 0.0, std::max(0.0, ny_ - 1.001));
    const int i = static_cast<int>(fx), j = static_cast<int>(fy);
    const int right = std::min(i + 1, nx_ - 1), up = std::min(j + 1, ny_ - 1);
    const double u = fx - i, v = fy - j;
    const auto value = [&](int a, int b) { return static_cast<double>(map[index(a, b)]); };
    return (1 - v) * ((1 - u) * value(i, j) + u * value(right, j)) +
           v * ((1 - u) * value(i, up) + u * value(right, up));
  }
  [[nodiscard]] double height(double x, double y) const { return static_cast<double>(z_[cell_of(x, y)]); }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] std::size_t cell_of(double x, double y) const {
    const int i = static_cast<int>((x - x0_) / kCellMm), j = static_cast<int>((y - y0_) / kCellMm);
    return index(std::clamp(i, 0, nx_ - 1), std::clamp(j, 0, ny_ - 1));
  }

  /// Highest or lowest of the cells within a disc; cells with nothing in them do not count.
  [[nodiscard]] std::vector<float> extreme(const std::vector<float>& map, int reach, bool highest) const {
    std::vector<float> out(map.size(), kNowhere);
    tbb::parallel_for(0, ny_, [&](int j) {
      for (int i = 0; i < nx_; ++i) {
        float best = highest ? kNowhere : std::numeric_limits<float>::max();
        for (int dj = std::max(-reach, -j); dj <= std::min(reach, ny_ - 1 - j); ++dj) {
          const int half = static_cast<int>(std::sqrt(reach * reach - dj * dj));
          for (int k = std::max(0, i - half); k <= std::min(nx_ - 1, i + half); ++k) {
            const float z = map[index(k, j + dj)];
            if (z != kNowhere) best = highest ? std::max(best, z) : std::min(best, z);
          }
        }
        out[index(i, j)] = best == std::numeric_limits<float>::max() ? kNowhere : best;
      }
    });
    return out;
  }

  double x0_ = 0, y0_ = 0;
  int nx_ = 1, ny_ = 1;
  std::vector<float> z_;
};

void spread_film(TriSurface& surface, const FilmConfig& config, std::uint64_t seed) {
  constexpr double kPatchMm = 3.5, kUnevenMm = 1.3, kUneven = 0.5;
  constexpr double kEdge = 0.2;  // of the noise: over it a patch thins out
  std::vector<double> dryness(surface.vertices.size());
  tbb::parallel_for(std::size_t{0}, dryness.size(), [&](std::size_t i) {
    dryness[i] = value_noise(surface.vertices[i].cast<double>() / kPatchMm, seed ^ 0x776574ULL);
  });
  double limit = 2;  // above all noise: everything is wet
  if (config.wet_share < 1) {
    std::vector<double> sorted = dryness;
    const auto nth = static_cast<std::ptrdiff_t>(config.wet_share * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), sorted.begin() + nth, sorted.end());
    limit = sorted[static_cast<std::size_t>(nth)];
  }
  tbb::parallel_for(std::size_t{0}, dryness.size(), [&](std::size_t i) {
    const double uneven = 1.0 + kUneven * value_noise(surface.vertices[i].cast<double>() / kUnevenMm, seed ^ 0x756EULL);
    const double whole = ramp((limit - dryness[i]) / kEdge);
    surface.film[i].thickness_mm = static_cast<float>(1e-3 * config.thickness_um * whole * uneven);
  });
}

void fill_pools(TriSurface& surface, double most_mm) {
  constexpr double kUpwards = 0.2, kOverhangMm = 0.3;  // of the normal's z; of what lies under something else
  const HeightMap heights(surface);
  const std::vector<float> depth = heights.pools(most_mm);
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
    const Vec3d p = surface.vertices[i].cast<double>();
    if (static_cast<double>(surface.normals[i].z()) < kUpwards) continue;
    if (p.z() < heights.height(p.x(), p.y()) - kOverhangMm) continue;
    const double d = heights.at(depth, p.x(), p.y()) - kNothingMm;
    Film& film = surface.film[i];
    if (d <= static_cast<double>(film.thickness_mm)) continue;
    film.level = static_cast<float>(ramp(d / (2.0 * kNothingMm)));
    film.thickness_mm = static_cast<float>(d);
  }
}

/// Rims scatter like foam; inside one the film is gone but for its skin.
void blow_bubbles(TriSurface& surface, const FilmConfig& config, const MaterialTable& materials, std::uint64_t seed) {
  constexpr double kLeastMm = 0.12, kMostMm = 0.4, kHollow = 0.65;
  constexpr auto kFoam = static_cast<std::uint8_t>(MaterialId::kFoam);
  std::vector<std::size_t> wet;
  for (std::size_t i = 0; i < surface.film.size(); ++i) {
    if (surface.film[i].thickness_mm > 0 && surface.normals[i].z() > 0) wet.push_back(i);
  }
  if (wet.empty()) return;
  surface.material.resize(surface.vertices.size(), 0);
  const CounterRandom random(seed, 0x6262ULL);
  for (int n = 0; n < config.bubbles; ++n) {
    const auto counter = static_cast<std::uint64_t>(2 * n);
    const auto at = static_cast<std::size_t>(random.uniform(counter) * static_cast<double>(wet.size()));
    const Vec3f centre = surface.vertices[wet[std::min(at, wet.size() - 1)]];
    const auto radius = static_cast<float>(random.uniform(counter + 1, kLeastMm, kMostMm));
    for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
      const float away = (surface.vertices[i] - centre).norm();
      if (away > radius) continue;
      surface.film[i] = Film{};
      if (away < static_cast<float>(kHollow) * radius) continue;
      surface.material[i] = kFoam;
      surface.albedo[i] = static_cast<float>(materials[index_of(MaterialId::kFoam)].albedo);
    }
  }
}

}  // namespace

void add_film(TriSurface& surface, const FilmConfig& config, const MaterialTable& materials, std::uint64_t seed) {
  if (config.is_dry() || surface.vertices.empty()) return;
  surface.film.assign(surface.vertices.size(), Film{});
  if (config.wet_share > 0) spread_film(surface, config, seed);
  if (config.pools_mm > 0) fill_pools(surface, config.pools_mm);
  blow_bubbles(surface, config, materials, seed);
}

}  // namespace enamel::twin
