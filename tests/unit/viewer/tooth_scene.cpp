#include "tests/unit/viewer/tooth_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "viewer/scene/probe_field.hpp"

namespace enamel::view::test {
namespace {

constexpr double kGumZ = 53.0;
constexpr double kPathMm = 48.0;

struct Tooth {
  double s;       ///< along the arch, mm
  double length;  ///< along the arch
  double width;   ///< across
  double height;
  int cusps;  ///< a side; 0 = edge
};

constexpr std::array<Tooth, 7> kTeeth{{{-3, 5.4, 6.0, 8.0, 0},
                                       {2.9, 5.6, 6.2, 8.2, 0},
                                       {9.5, 7.0, 7.4, 9.0, 1},
                                       {16.6, 6.8, 8.4, 7.6, 1},
                                       {23.6, 6.8, 8.8, 7.2, 1},
                                       {32.5, 10.4, 10.2, 6.6, 2},
                                       {43.0, 10.0, 10.0, 6.0, 2}}};

/// Arch as a curve: x along, bending in y.
Vec3d arch_point(double s) {
  const double t = s / kPathMm;
  return {s * (1 - 0.10 * t * t), 15.0 * std::pow(std::max(0.0, 1 - 0.9 * t), 2.2) - 4.0, 0};
}

/// Nearest arch length and signed distance across.
std::array<double, 2> arch_coordinates(double x, double y) {
  double best = 1e30;
  std::array<double, 2> out{};
  for (double s = -8; s <= 52; s += 0.5) {
    const Vec3d p = arch_point(s);
    const Vec3d q = arch_point(s + 0.5);
    const Vec3d d = q - p;
    const double along = std::clamp(((x - p.x()) * d.x() + (y - p.y()) * d.y()) / d.squaredNorm(), 0.0, 1.0);
    const Vec3d at = p + along * d;
    const double off2 = (x - at.x()) * (x - at.x()) + (y - at.y()) * (y - at.y());
    if (off2 < best) {
      best = off2;
      const double side = (d.x() * (y - p.y()) - d.y() * (x - p.x())) >= 0 ? 1.0 : -1.0;
      out = {s + 0.5 * along, side * std::sqrt(off2)};
    }
  }
  return out;
}

double crown(const Tooth& t, double s, double across) {
  const double a = (s - t.s) / (0.5 * t.length);
  const double b = across / (0.5 * t.width);
  const double r = std::pow(std::pow(std::abs(a), 3.0) + std::pow(std::abs(b), 2.6), 1.0 / 2.8);
  if (r >= 1) {
    return 0;
  }
  double top = t.height * std::pow(1 - std::pow(r, 5.0), 0.45);
  if (t.cusps == 0) {
    return top * (0.45 + 0.55 * std::exp(-std::pow((b + 0.15) / 0.55, 2)));
  }
  double relief = 0;
  const double spread = t.cusps == 2 ? 0.42 : 0.0;
  for (const double side : {-0.46, 0.46}) {
    for (const double along : {-spread, spread}) {
      relief = std::max(relief, std::exp(-(std::pow((a - along) / 0.42, 2) + std::pow((b - side) / 0.40, 2))));
    }
  }
  const double fissure = 0.5 * std::exp(-std::pow((b - 0.10 * std::sin(5 * a)) / 0.10, 2));
  return top * (0.74 + 0.27 * relief) - fissure * std::max(0.0, 1 - r * r) * 0.9;
}

/// Height over the gum plane in mm, or none where nothing is scanned.
std::optional<double> relief(double x, double y) {
  const auto [s, across] = arch_coordinates(x, y);
  const double ragged = 0.5 * std::sin(1.9 * s) + 0.35 * std::sin(4.3 * s + across);
  if (std::abs(across) > 8.0 + ragged || s < -6.4 + 0.4 * ragged || s > 49.5 + ragged) {
    return std::nullopt;
  }
  double top = 0;
  double ridge = 2.2 * std::exp(-std::pow(across / 5.6, 2));
  for (const Tooth& t : kTeeth) {
    top = std::max(top, crown(t, s, across));
    ridge += 0.35 * std::exp(-std::pow((s - t.s) / (0.55 * t.length), 2)) * std::exp(-std::pow(across / 6.5, 2));
  }
  return std::max(ridge, 0.9 * ridge + top - 0.8);
}

struct Sample {
  bool valid = false;
  Vec3f point = Vec3f::Zero();
  Vec3f normal = Vec3f::Zero();
};

struct Field {
  int width, height;
  double x0, y0, step;
  std::vector<Sample> samples;

  [[nodiscard]] const Sample& at(int i, int j) const {
    return samples[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)];
  }
};

Field make_field(double step) {
  Field field{static_cast<int>(66 / step), static_cast<int>(48 / step), -12.0, -18.0, step, {}};
  std::vector<std::optional<double>> heights;
  for (int j = 0; j < field.height; ++j) {
    for (int i = 0; i < field.width; ++i) {
      heights.push_back(relief(field.x0 + i * step, field.y0 + j * step));
    }
  }
  const auto height = [&](int i, int j) {
    return heights[static_cast<std::size_t>(j) * static_cast<std::size_t>(field.width) + static_cast<std::size_t>(i)];
  };
  field.samples.resize(heights.size());
  for (int j = 1; j + 1 < field.height; ++j) {
    for (int i = 1; i + 1 < field.width; ++i) {
      const auto h = height(i, j), l = height(i - 1, j), r = height(i + 1, j), u = height(i, j - 1),
                 d = height(i, j + 1);
      if (!h || !l || !r || !u || !d) {
        continue;
      }
      const Vec3d normal(-(*r - *l) / (2 * step), -(*d - *u) / (2 * step), -1);
      Sample& out = field.samples[static_cast<std::size_t>(j) * static_cast<std::size_t>(field.width) +
                                  static_cast<std::size_t>(i)];
      out = {true, Vec3d(field.x0 + i * step, field.y0 + j * step, kGumZ - *h).cast<float>(),
             normal.normalized().cast<float>()};
    }
  }
  return field;
}

const Field& field_of(double step) {
  static std::map<double, Field> cache;
  const auto known = cache.find(step);
  return known != cache.end() ? known->second : cache.emplace(step, make_field(step)).first->second;
}

/// How far along the path the block was last seen, in bursts of one millimetre; negative = not reached.
double visits(double path_s, double block_s) { return path_s + 7.0 - block_s; }

std::shared_ptr<const BlockMesh> make_block(const Field& field, std::array<std::int32_t, 3> index, double edge,
                                            double share, std::uint64_t epoch) {
  auto mesh = std::make_shared<BlockMesh>();
  mesh->block = index;
  mesh->epoch = epoch;
  std::map<std::array<int, 2>, std::uint32_t> known;
  const auto vertex = [&](int i, int j) {
    const auto [it, fresh] = known.emplace(std::array{i, j}, static_cast<std::uint32_t>(mesh->vertices.size()));
    if (fresh) {
      const Sample& s = field.at(i, j);
      mesh->vertices.push_back(s.point);
      mesh->normals.push_back(s.normal);
      mesh->quality.push_back(static_cast<float>(std::clamp(share, 0.0, 1.0)) *
                              (0.25F + 0.75F * std::pow(-s.normal.z(), 0.7F)));
    }
    return it->second;
  };
  const int i0 = static_cast<int>(std::ceil((index[0] * edge - field.x0) / field.step));
  const int i1 = static_cast<int>(std::ceil(((index[0] + 1) * edge - field.x0) / field.step));
  const int j0 = static_cast<int>(std::ceil((index[1] * edge - field.y0) / field.step));
  const int j1 = static_cast<int>(std::ceil(((index[1] + 1) * edge - field.y0) / field.step));
  for (int j = std::max(j0, 0); j < std::min(j1, field.height - 1); ++j) {
    for (int i = std::max(i0, 0); i < std::min(i1, field.width - 1); ++i) {
      if (field.at(i, j).valid && field.at(i + 1, j).valid && field.at(i, j + 1).valid &&
          field.at(i + 1, j + 1).valid) {
        const auto a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i, j + 1), d = vertex(i + 1, j + 1);
        mesh->triangles.push_back({a, c, b});
        mesh->triangles.push_back({b, c, d});
      }
    }
  }
  return mesh;
}

}  // namespace

Pose ToothScene::pose(double share) const {
  const double s = kPathMm * share - 2;
  const Vec3d over = arch_point(s);
  Pose T = Pose::Identity();
  T.linear() = (Eigen::AngleAxisd(0.14 * std::sin(9 * share), Vec3d::UnitX()) *
                Eigen::AngleAxisd(0.12 * std::sin(6 * share + 1), Vec3d::UnitY()) *
                Eigen::AngleAxisd(-0.5 + 0.45 * share, Vec3d::UnitZ()))
                   .toRotationMatrix();
  T.translation() = Vec3d(over.x(), over.y(), 47) - T.linear() * Vec3d(0, 0, 47.5);
  return T;
}

std::shared_ptr<const ModelSnapshot> ToothScene::model(double share, std::uint64_t burst,
                                                       const ModelSnapshot* previous) const {
  const Field& field = field_of(step_mm);
  auto out = std::make_shared<ModelSnapshot>();
  out->after_burst = burst;
  const double path_s = kPathMm * share - 2;
  const auto bi = [&](double v) { return static_cast<std::int32_t>(std::floor(v / block_mm)); };
  for (std::int32_t bx = bi(field.x0); bx <= bi(field.x0 + field.width * step_mm); ++bx) {
    for (std::int32_t by = bi(field.y0); by <= bi(field.y0 + field.height * step_mm); ++by) {
      const double seen = visits(path_s, arch_coordinates((bx + 0.5) * block_mm, (by + 0.5) * block_mm)[0]);
      if (seen <= 0) {
        continue;
      }
      const std::array<std::int32_t, 3> index{bx, by, bi(kGumZ - 4)};
      if (previous != nullptr && seen > 16) {  // the field has moved on: the block stays as it was
        const auto same = std::find_if(previous->blocks.begin(), previous->blocks.end(),
                                       [&](const auto& b) { return b->block == index && b->epoch > 1; });
        if (same != previous->blocks.end()) {
          out->blocks.push_back(*same);
          continue;
        }
      }
      auto block = make_block(field, index, block_mm, std::min(seen, 16.0) / 16.0, burst + 1);
      if (!block->triangles.empty()) {
        out->blocks.push_back(std::move(block));
      }
    }
  }
  return out;
}

std::shared_ptr<const Map<std::uint8_t>> ToothScene::live_image(const Pose& T_model_cam) const {
  auto image = std::make_shared<Map<std::uint8_t>>(live_width, live_height, std::uint8_t{10});
  const Field& field = field_of(step_mm);
  const ProbeField rays;
  for (int v = 0; v < live_height; ++v) {
    for (int u = 0; u < live_width; ++u) {
      const double a = 2.0 * u / (live_width - 1) - 1;
      const double b = 2.0 * v / (live_height - 1) - 1;
      const Vec3d ray = T_model_cam.linear() * Vec3d(a * static_cast<double>(rays.corner_rays[1].x()),
                                                     b * static_cast<double>(rays.corner_rays[2].y()), 1);
      double z = 47;
      const Sample* hit = nullptr;
      for (int k = 0; k < 8; ++k) {
        const double t = (z - T_model_cam.translation().z()) / ray.z();
        const Vec3d at = T_model_cam.translation() + t * ray;
        const int i = static_cast<int>(std::lround((at.x() - field.x0) / step_mm));
        const int j = static_cast<int>(std::lround((at.y() - field.y0) / step_mm));
        hit =
            i >= 0 && j >= 0 && i < field.width && j < field.height && field.at(i, j).valid ? &field.at(i, j) : nullptr;
        if (hit == nullptr) {
          break;
        }
        z = 0.5 * z + 0.5 * static_cast<double>(hit->point.z());
      }
      if (hit != nullptr) {
        const double facing = std::max(0.0, -hit->normal.cast<double>().dot(ray.normalized()));
        const double fall = 1.1 - 0.35 * (a * a + b * b);
        const double gum = static_cast<double>(hit->point.z()) > kGumZ - 3.6 ? 0.45 : 1.0;
        (*image)(u, v) =
            static_cast<std::uint8_t>(std::clamp(215 * fall * gum * std::pow(facing, 1.3) + 8, 0.0, 255.0));
      }
    }
  }
  return image;
}

std::shared_ptr<PreviewFrame> ToothScene::frame(int i, int n, const PreviewFrame* previous) const {
  const double share = n > 1 ? static_cast<double>(i) / (n - 1) : 1.0;
  auto out = std::make_shared<PreviewFrame>();
  out->burst = BurstId{static_cast<std::uint64_t>(i)};
  out->state = ScanState::kScanning;
  out->placed = true;
  out->track = i == 0 ? TrackState::kStarted : TrackState::kTracking;
  out->track_overlap = 0.9;
  out->T_model_cam = pose(share);
  out->surface_distance_mm = 47.6 + 2.0 * std::sin(11 * share);
  out->live = live_image(out->T_model_cam);
  out->model = model(share, static_cast<std::uint64_t>(i), previous != nullptr ? previous->model.get() : nullptr);
  out->counters.captured = static_cast<std::uint64_t>(i + 1);
  out->counters.fused = static_cast<std::uint64_t>(i + 1);
  out->rate_hz = 21.4;
  out->latency_ms = 74;
  out->simulated = true;
  return out;
}

std::shared_ptr<const ModelSnapshot> half_soft(const ModelSnapshot& model) {
  auto out = std::make_shared<ModelSnapshot>(model);
  for (std::size_t k = 0; k < out->blocks.size(); k += 2) {
    auto block = std::make_shared<BlockMesh>(*out->blocks[k]);
    block->soft.assign(block->vertices.size(), 1);
    ++block->epoch;
    out->blocks[k] = std::move(block);
  }
  return out;
}

}  // namespace enamel::view::test
