// Test-only forward model: ideal four-frame bursts of analytic scenes. It shares the lens formula of calib/model
// (tested on its own) but none of the decoder's phase, unwrapping or triangulation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "calib/model/lens.hpp"
#include "pipeline/types/map.hpp"
#include "tests/unit/calib/rig_text.hpp"
#include "tests/unit/decode/frame_set.hpp"

namespace enamel::test {

/// The rig of kRigText, cropped to width x height pixels about its centre: same scale, fewer pixels.
inline calib::Rig cropped_rig(int width, int height) {
  calib::Rig rig = calib::parse_rig(kRigText).value();
  rig.camera.cx -= (rig.camera.width - width) / 2.0;
  rig.camera.cy -= (rig.camera.height - height) / 2.0;
  rig.camera.width = width;
  rig.camera.height = height;
  return rig;
}

/// Deterministic unit normals: 64-bit LCG and Box-Muller in double.
class Normals {
 public:
  explicit Normals(std::uint64_t seed) : state_(seed * 2654435769U + 1) {}
  double operator()() {
    const double a = uniform();
    const double b = uniform();
    return std::sqrt(-2 * std::log(a)) * std::cos(2 * std::numbers::pi * b);
  }

 private:
  double uniform() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return (static_cast<double>(state_ >> 11U) + 0.5) / 9007199254740992.0;
  }
  std::uint64_t state_;
};

struct SceneOptions {
  double mean_dn = 104;  ///< above black
  double modulation_dn = 80;
  double motion_rad = 0;  ///< phase change per frame interval, zero at mid-burst
  double harmonic = 0;    ///< projector's B2/B1
  /// Projector's B3/B1 at a depth in mm: what defocus leaves of it. Needs no harmonic, no blur_fringe.
  std::function<double(double z)> third = [](double) { return 0.0; };
  double blur_fringe = 0;  ///< sigma of the projector's Gaussian blur; takes exp(-(2 pi sigma)^2 / 2) of the modulation
  double psf_px = 0;       ///< sigma of the camera's Gaussian point spread
  bool noise = false;
  int bits = 8;  ///< of the frames; levels stay those of 8 bits, finer steps between
  std::uint64_t seed = 1;
  /// Light on the pixel, 0…1; depth may be anything where it is 0.
  std::function<double(int u, int v)> light = [](int, int) { return 1.0; };
  /// Times modulation_dn: what translucent matter leaves of it.
  std::function<double(int u, int v)> contrast = [](int, int) { return 1.0; };
};

/// Sensor noise on, at a contrast of 0.8 above a pedestal of 3 DN.
inline SceneOptions noisy(double modulation_dn = 80) {
  SceneOptions o;
  o.noise = true;
  o.modulation_dn = modulation_dn;
  o.mean_dn = modulation_dn * 1.25 + 3;
  return o;
}

/// Sensor noise on, light as it is.
inline SceneOptions with_noise() {
  SceneOptions o;
  o.noise = true;
  return o;
}

struct SyntheticBurst {
  FrameSet frames;
  Map<double> phase_rad;  ///< true absolute Phi at mid-burst
  Map<double> depth_mm;
};

inline double wave(double phi, double harmonic) { return std::cos(phi) + harmonic * std::cos(2 * phi); }

/// What frame k of the pattern set shows at absolute phase p: -1 … 1 but for the harmonic.
inline double frame_wave(const calib::PatternValues& pattern, int k, double p, double harmonic) {
  if (pattern.mode == calib::PatternMode::kMicro) {
    if (k == 1) return wave(p + p / pattern.code_ratio, harmonic);
    return wave(p + (k == 0 ? 0 : k - 1) * 2 * std::numbers::pi / 3, harmonic);
  }
  const auto& code = pattern.polarity_code;
  int b = 1;
  if (k == 3 && !code.empty()) {
    const int cell = static_cast<int>(std::floor(p / std::numbers::pi)) + pattern.first_cell;
    b = code[static_cast<std::size_t>(cell) % code.size()];
  }
  if (k == 3 && pattern.mode == calib::PatternMode::kSingle &&
      static_cast<int>(std::floor(p / (2 * std::numbers::pi))) == pattern.marker_fringe)
    b = -1;
  const double shift = k == 3 && b < 0 ? 1 : k;  // the flipped fourth frame is the second one again
  return wave(p + shift * std::numbers::pi / 2, harmonic);
}

/// The patterns over absolute phase as they reach the surface, behind the projector's blur.
class ProjectedPatterns {
 public:
  ProjectedPatterns(const calib::Rig& rig, double harmonic, double blur_fringe)
      : pattern_(rig.patterns), harmonic_(harmonic) {
    if (blur_fringe > 0) tabulate(rig.projector.width / rig.patterns.period_px, blur_fringe);
  }

  double operator()(int k, double phi) const {
    if (table_[0].empty()) return frame_wave(pattern_, k, phi, harmonic_);
    const auto& t = table_[static_cast<std::size_t>(k)];
    const double x = std::clamp(phi / kStep_rad, 0.0, static_cast<double>(t.size() - 2));
    const auto i = static_cast<std::size_t>(x);
    return t[i] + (x - static_cast<double>(i)) * (t[i + 1] - t[i]);
  }

 private:
  static constexpr int kPerFringe = 256;  ///< linear interpolation to 1e-4 of the amplitude
  static constexpr double kStep_rad = 2 * std::numbers::pi / kPerFringe;

  void tabulate(double fringes, double blur_fringe) {
    const int points = static_cast<int>(std::ceil(fringes + 1)) * kPerFringe;
    const int reach = static_cast<int>(std::ceil(4 * blur_fringe * kPerFringe));
    std::vector<double> weight;
    for (int j = -reach; j <= reach; ++j)
      weight.push_back(std::exp(-0.5 * std::pow(j / (blur_fringe * kPerFringe), 2)));
    const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
    for (int k = 0; k < 4; ++k) {
      std::vector<double> sharp;
      for (int i = -reach; i < points + reach; ++i) {
        sharp.push_back(frame_wave(pattern_, k, std::max(0, i) * kStep_rad + 1e-9, harmonic_));
      }
      auto& t = table_[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < static_cast<std::size_t>(points); ++i) {
        t.push_back(
            std::inner_product(weight.begin(), weight.end(), sharp.begin() + static_cast<std::ptrdiff_t>(i), 0.0) /
            total);
      }
    }
  }

  const calib::PatternValues& pattern_;
  double harmonic_;
  std::array<std::vector<double>, 4> table_;
};

/// Separable Gaussian, values beyond the border as on it.
inline void blur_image(Map<double>& image, double sigma_px) {
  const int w = image.width(), h = image.height(), reach = static_cast<int>(std::ceil(4 * sigma_px));
  std::vector<double> weight;
  for (int j = -reach; j <= reach; ++j) weight.push_back(std::exp(-0.5 * j * j / (sigma_px * sigma_px)));
  const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (const bool along : {true, false}) {
    const Map<double> sharp = image;
    for (int v = 0; v < h; ++v) {
      for (int u = 0; u < w; ++u) {
        double sum = 0;
        for (int j = -reach; j <= reach; ++j) {
          sum += weight[static_cast<std::size_t>(j + reach)] *
                 sharp(along ? std::clamp(u + j, 0, w - 1) : u, along ? v : std::clamp(v + j, 0, h - 1));
        }
        image(u, v) = sum / total;
      }
    }
  }
}

/// Of mode M's code frame: the design's, and that of config/rigs/probe.json (ADR-0007).
inline constexpr double kDesignRatio = 6, kShippedRatio = 7;

/// The same rig projecting mode M.
inline calib::Rig micro_rig(int width, int height, double code_ratio = kDesignRatio) {
  calib::Rig rig = cropped_rig(width, height);
  rig.patterns.mode = calib::PatternMode::kMicro;
  rig.patterns.steps = 3;
  rig.patterns.polarity_code.clear();
  rig.patterns.code_ratio = code_ratio;
  return rig;
}

/// What both lenses leave of the light of a point at depth z on the ray (x, y, 1): the fourth power of the cosine.
inline double lens_falloff(const calib::Rig& rig, double x, double y, double z) {
  std::array<double, 3> p{};  // before the projector
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& row = rig.T_proj_cam[k];
    p[k] = z * (row[0] * x + row[1] * y + row[2]) + row[3];
  }
  const double camera = 1 / (1 + x * x + y * y), projector = p[2] * p[2] / (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
  return camera * camera * projector * projector;
}

/// SceneOptions::light of a uniform surface behind such lenses.
inline std::function<double(int, int)> lens_light(const calib::Rig& rig, const std::function<double(int, int)>& depth) {
  return [rig, depth](int u, int v) {
    const calib::PlanePoint ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
    return lens_falloff(rig, ray.x, ray.y, depth(u, v));
  };
}

/// Mean light of the four frames, DN above black, and the truth beside it.
inline std::array<Map<double>, 4> mean_light(const calib::Rig& rig, const std::function<double(int, int)>& depth,
                                             const SceneOptions& o, SyntheticBurst& truth) {
  const int w = rig.camera.width, h = rig.camera.height;
  const ProjectedPatterns patterns(rig, o.harmonic, o.blur_fringe);
  std::array<Map<double>, 4> signal;
  for (auto& map : signal) map = Map<double>(w, h);
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      const double z = depth(u, v), light = o.light(u, v), modulation_dn = o.modulation_dn * o.contrast(u, v);
      const calib::PlanePoint ray = calib::undistort(rig.camera, {static_cast<double>(u), static_cast<double>(v)});
      const double phi = 2 * std::numbers::pi * calib::project_to_projector(rig, ray, z).x / rig.patterns.period_px;
      truth.phase_rad(u, v) = phi;
      truth.depth_mm(u, v) = z;
      for (int k = 0; k < 4; ++k) {
        const double p = phi + o.motion_rad * (k - 1.5);
        const double first = patterns(k, p), third = o.third(z) * (4 * first * first - 3) * first;  // cos 3x of cos x
        signal[static_cast<std::size_t>(k)](u, v) = light * (o.mean_dn + modulation_dn * (first + third));
      }
    }
  }
  if (o.psf_px > 0) {
    for (auto& map : signal) blur_image(map, o.psf_px);
  }
  return signal;
}

/// depth: camera z of the pixel's ray, mm. Needs mode T, M, single or plain4 and rig.noise.
inline SyntheticBurst render(const calib::Rig& rig, const std::function<double(int, int)>& depth,
                             const SceneOptions& o = {}) {
  const int w = rig.camera.width, h = rig.camera.height;
  SyntheticBurst out{{w, h, {}, o.bits}, Map<double>(w, h), Map<double>(w, h)};
  const auto light = mean_light(rig, depth, o, out);
  const double steps = std::pow(2.0, o.bits - 8);
  Normals normal(o.seed);
  const auto& n = *rig.noise;
  for (std::size_t i = 0; i < out.depth_mm.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) {
      const double signal = light[k][i];
      double dn = n.black_dn + signal;
      if (o.noise) {
        const double electrons = std::max(0.0, signal) * n.gain_e_per_dn;
        dn += (std::sqrt(electrons) * normal() + n.read_noise_e * normal()) / n.gain_e_per_dn;
      }
      const auto level = std::clamp(std::lround(dn * steps), 0L, std::lround(256 * steps) - 1);
      auto& bytes = out.frames.frames[k];
      bytes.push_back(static_cast<std::uint8_t>(level & 255));
      if (o.bits > 8) bytes.push_back(static_cast<std::uint8_t>(level >> 8));
    }
  }
  return out;
}

/// A burst whose frames show the scene at their own times. scene(tau): its burst, were it still as it is tau frame
/// intervals after mid-burst.
template <class Scene>
FrameSet frames_in_motion(const Scene& scene) {
  FrameSet out;
  for (std::size_t k = 0; k < 4; ++k) {
    FrameSet at = scene(static_cast<double>(k) - 1.5).frames;
    if (k == 0) out = at;
    out.frames[k] = std::move(at.frames[k]);
  }
  return out;
}

inline std::function<double(int, int)> flat(double z_mm) {
  return [z_mm](int, int) { return z_mm; };
}

/// Depth change that moves the phase of the rig's central pixel by exactly one fringe, from z on towards the camera.
inline double fringe_jump_mm(const calib::Rig& rig, double z_mm) {
  const calib::PlanePoint ray = calib::undistort(rig.camera, {rig.camera.width / 2.0, rig.camera.height / 2.0});
  const double u0 = calib::project_to_projector(rig, ray, z_mm).x;
  double low = 0, high = 8;
  for (int i = 0; i < 60; ++i) {
    const double mid = 0.5 * (low + high);
    (std::abs(calib::project_to_projector(rig, ray, z_mm - mid).x - u0) < rig.patterns.period_px ? low : high) = mid;
  }
  return low;
}

}  // namespace enamel::test
