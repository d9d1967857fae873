// Surfaces drawn by a seed for the detectors of host/defects: sound ones, and the same with one thing wrong.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "host/defects/report_defects.hpp"
#include "pipeline/types/mesh.hpp"

namespace enamel::host::drawn {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11U) * 0x1p-53;
  }
  double normal(double sigma) {
    const double u = std::max(uniform(0, 1), 1e-300);
    return sigma * std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * uniform(0, 1));
  }

 private:
  std::mt19937_64 engine_;
};

/// Points of a parameter rectangle, joined by triangles; `keep` leaves out facets by their middle. closed: the first
/// parameter comes round.
struct Sheet {
  int nu = 0, nv = 0;
  bool is_closed = false;
  std::function<Vec3d(int, int)> at;
  std::function<bool(const Vec3d&)> keep = [](const Vec3d&) { return true; };
};

inline void append(Mesh& mesh, const Sheet& sheet) {
  const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int v = 0; v < sheet.nv; ++v)
    for (int u = 0; u < sheet.nu; ++u) mesh.vertices.push_back(sheet.at(u, v).cast<float>());
  const auto index = [&](int u, int v) { return base + static_cast<std::uint32_t>(v * sheet.nu + u % sheet.nu); };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const Vec3f middle = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    if (sheet.keep(middle.cast<double>())) mesh.triangles.push_back({a, b, c});
  };
  for (int v = 0; v + 1 < sheet.nv; ++v) {
    for (int u = 0; u < (sheet.is_closed ? sheet.nu : sheet.nu - 1); ++u) {
      add(index(u, v), index(u + 1, v), index(u + 1, v + 1));
      add(index(u, v), index(u + 1, v + 1), index(u, v + 1));
    }
  }
}

/// Height of a biting surface, mm: cusps of some mm.
class Relief {
 public:
  explicit Relief(Draw& draw) {
    for (double& p : phase_) p = draw.uniform(0, 2 * std::numbers::pi);
    height_ = draw.uniform(0.3, 0.8);
  }
  [[nodiscard]] double operator()(double x, double y) const {
    return height_ *
           (std::sin(0.9 * x + phase_[0]) * std::cos(0.8 * y + phase_[1]) + 0.3 * std::sin(1.7 * y + phase_[2]));
  }

 private:
  std::array<double, 3> phase_{};
  double height_ = 0;
};

struct Ground {
  double half_mm = 5, step_mm = 0.1, noise_mm = 0.002;
  std::function<bool(const Vec3d&)> keep = [](const Vec3d&) { return true; };
};

/// z up, over a square.
inline Mesh ground(Draw& draw, const Relief& relief, const Ground& g = {}) {
  Mesh mesh;
  const int n = static_cast<int>(2 * g.half_mm / g.step_mm) + 1;
  append(mesh, {n, n, false,
                [&](int u, int v) {
                  const double x = g.step_mm * u - g.half_mm, y = g.step_mm * v - g.half_mm;
                  return Vec3d(x, y, relief(x, y) + draw.normal(g.noise_mm));
                },
                g.keep});
  add_normals(mesh);
  return mesh;
}

/// Two sides of a wall, thickness apart, standing on the ground: a web, or a tooth's edge.
inline void add_wall(Draw& draw, Mesh& mesh, double thickness_mm) {
  constexpr double kStep = 0.1;
  const int across = static_cast<int>(draw.uniform(20, 30)), up = static_cast<int>(draw.uniform(20, 30));
  const double turn = draw.uniform(0, std::numbers::pi);
  const Vec3d along(std::cos(turn), std::sin(turn), 0), out(-std::sin(turn), std::cos(turn), 0);
  for (const double side : {-0.5, 0.5}) {
    append(mesh, {across, up, false, [&](int u, int v) {
                    const double s = kStep * (side < 0 ? u : across - 1 - u);
                    return Vec3d((s - 0.05 * across) * along + (side * thickness_mm + draw.normal(0.002)) * out +
                                 (3 + kStep * v) * Vec3d::UnitZ());
                  }});
  }
  add_normals(mesh);
}

/// A body turned about z: profile of (radius, z) from the middle of its top outwards and down. Facets face out.
inline Mesh turned(Draw& draw, const std::vector<Vec2f>& profile, double noise_mm,
                   const std::function<double(double, double, double)>& radius_at) {
  Mesh mesh;
  constexpr int kAround = 140;
  append(mesh, {kAround, static_cast<int>(profile.size()), true, [&](int u, int v) {
                  const double a = -2 * std::numbers::pi * u / kAround;
                  const Vec2f& p = profile[static_cast<std::size_t>(v)];
                  const double rho = radius_at(a, static_cast<double>(p.x()), static_cast<double>(p.y()));
                  return Vec3d(rho * std::cos(a) + draw.normal(noise_mm), rho * std::sin(a) + draw.normal(noise_mm),
                               static_cast<double>(p.y()) + draw.normal(noise_mm));
                }});
  add_normals(mesh);
  return mesh;
}

/// From corner to corner in steps, corners rounded to a radius.
inline std::vector<Vec2f> rounded(const std::vector<Vec2f>& corners, const std::vector<double>& radii, double step_mm) {
  std::vector<Vec2f> out;
  const auto line_to = [&](const Vec2f& to) {
    const Vec2f from = out.back();
    const int n = std::max(1, static_cast<int>(static_cast<double>((to - from).norm()) / step_mm));
    for (int i = 1; i <= n; ++i) out.emplace_back(from + (to - from) * (static_cast<float>(i) / static_cast<float>(n)));
  };
  out.push_back(corners.front());
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec2f in = (corners[i] - corners[i - 1]).normalized(), away = (corners[i + 1] - corners[i]).normalized();
    const double turn = std::acos(std::clamp(static_cast<double>(in.dot(away)), -1.0, 1.0));
    const auto cut = static_cast<float>(radii[i] * std::tan(0.5 * turn));
    const Vec2f begin = corners[i] - cut * in;
    line_to(begin);
    const bool right = in.x() * away.y() - in.y() * away.x() < 0;
    const Vec2f to_middle = right ? Vec2f(in.y(), -in.x()) : Vec2f(-in.y(), in.x());
    const Vec2f middle = begin + static_cast<float>(radii[i]) * to_middle;
    const int n = std::max(2, static_cast<int>(radii[i] * turn / step_mm));
    for (int k = 1; k <= n; ++k) {
      const double a = (right ? -turn : turn) * k / n;
      out.emplace_back(middle + Eigen::Rotation2Df(static_cast<float>(a)) * (begin - middle));
    }
  }
  line_to(corners.back());
  return out;
}

inline void move(Draw& draw, Mesh& mesh, Pose& T_model_body) {
  const Vec3d axis = Vec3d(draw.normal(1), draw.normal(1), draw.normal(1)).normalized();
  T_model_body = Pose(Eigen::AngleAxisd(draw.uniform(0, 3), axis));
  T_model_body.translation() = Vec3d{draw.uniform(-9, 9), draw.uniform(-9, 9), draw.uniform(30, 60)};
  for (Vec3f& p : mesh.vertices) p = (T_model_body * p.cast<double>()).cast<float>();
  for (Vec3f& n : mesh.normals) n = T_model_body.linear().cast<float>() * n;
}

}  // namespace enamel::host::drawn
