// What a pass of ICP works on, eight samples side by side. Private to register/icp/accumulate.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "pipeline/register/icp/accumulate.hpp"

namespace enamel::pipeline {

inline constexpr std::size_t kLanes = 8;
/// Samples that one lane sums up in float before its sum goes into double; chosen: 64 weights differ by a digit or so.
inline constexpr std::size_t kLaneSamples = 64;

/// A rigid motion in float; r row by row.
struct FloatMotion {
  explicit FloatMotion(const Pose& T) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index k = 0; k < 3; ++k) r[static_cast<std::size_t>(3 * i + k)] = static_cast<float>(T(i, k));
      t[static_cast<std::size_t>(i)] = static_cast<float>(T(i, 3));
    }
  }
  std::array<float, 9> r{};
  std::array<float, 3> t{};
};

/// The same for all samples of a pass.
struct AlignLanes {
  static constexpr int kPixelFloats = sizeof(Reference::Pixel) / sizeof(float);
  static_assert(offsetof(Reference::Pixel, normal) == 4 * sizeof(float));

  AlignLanes(const Alignment& of, const Pose& T_model_cam, const MatchGate& match_gate, const RobustKernel& by)
      : to_model(T_model_cam),
        to_view(of.reference.T_model_cam().inverse() * T_model_cam),
        gate(match_gate),
        kernel(by),
        pixels(of.reference.empty() ? nullptr : of.reference.pixel(0).point.data()),
        width(of.reference.width()),
        height(of.reference.height()),
        fx(of.camera.fx()),
        fy(of.camera.fy()),
        cx(of.camera.cx()),
        cy(of.camera.cy()),
        scale(of.reference.pixels_per_camera_pixel()),
        inv_rho(static_cast<float>(1 / of.rho_mm)) {
    const Vec3d about = T_model_cam * of.samples.centroid;
    for (std::size_t k = 0; k < 3; ++k) {
      axis[k] = static_cast<float>(of.reference.T_model_cam()(static_cast<Eigen::Index>(k), 2));
      centre[k] = static_cast<float>(about[static_cast<Eigen::Index>(k)]);
    }
  }

  FloatMotion to_model, to_view;
  MatchGate gate;
  RobustKernel kernel;
  const float* pixels;  ///< of the reference, kPixelFloats each
  int width, height;
  float fx, fy, cx, cy;
  float scale;    ///< pixels of the reference a camera pixel
  float inv_rho;  ///< 1/mm
  std::array<float, 3> axis{}, centre{};
};

struct SamplePointers {
  SamplePointers() = default;
  SamplePointers(const SampleSet& s, std::size_t first)
      : x(&s.x[first]),
        y(&s.y[first]),
        z(&s.z[first]),
        nx(&s.nx[first]),
        ny(&s.ny[first]),
        nz(&s.nz[first]),
        weight(&s.weights[first]) {}
  void advance(std::size_t n) { x += n, y += n, z += n, nx += n, ny += n, nz += n, weight += n; }
  const float *x = nullptr, *y = nullptr, *z = nullptr, *nx = nullptr, *ny = nullptr, *nz = nullptr;
  const float* weight = nullptr;
};

/// Fewer than eight at a set's end, with room for eight.
class LastSamples {
 public:
  LastSamples(const SampleSet& s, std::size_t first) {
    std::size_t n = 0;
    for (const auto* values : {&s.x, &s.y, &s.z, &s.nx, &s.ny, &s.nz, &s.weights})
      std::copy(values->begin() + static_cast<std::ptrdiff_t>(first), values->end(), values_[n++].begin());
  }
  [[nodiscard]] SamplePointers pointers() const {
    SamplePointers out;
    out.x = values_[0].data(), out.y = values_[1].data(), out.z = values_[2].data();
    out.nx = values_[3].data(), out.ny = values_[4].data(), out.nz = values_[5].data();
    out.weight = values_[6].data();
    return out;
  }

 private:
  std::array<std::array<float, kLanes>, 7> values_{};
};

/// Sums in float, one a lane.
struct LaneSums {
  static constexpr std::size_t kGradient = 21, kKernelWeight = 27, kWeight = 28, kWeightedE2 = 29, kCount = 30;
  alignas(32) std::array<std::array<float, kLanes>, kCount> of{};
  std::array<std::int32_t, kLanes> bins{};  ///< of the last eight residuals
  std::size_t matches = 0, contradictions = 0;
};

class DoubleSums {
 public:
  /// Lane by lane; the lanes begin anew.
  void take(LaneSums& lanes) {
    for (std::size_t n = 0; n < of_.size(); ++n) {
      for (const float sum : lanes.of[n]) of_[n] += static_cast<double>(sum);
      lanes.of[n] = {};
    }
  }
  void put(AlignPass& pass) const {
    std::size_t n = 0;
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index k = i; k < 6; ++k) pass.system.H(i, k) = pass.system.H(k, i) = of_[n++];
      pass.system.g[i] = of_[LaneSums::kGradient + static_cast<std::size_t>(i)];
    }
    pass.system.weight = of_[LaneSums::kKernelWeight];
    pass.weight = of_[LaneSums::kWeight];
    pass.weighted_e2 = of_[LaneSums::kWeightedE2];
  }

 private:
  std::array<double, LaneSums::kCount> of_{};
};

}  // namespace enamel::pipeline
