// Photon Monte Carlo of a scattering half space, independent of the twin: what a fringe thrown on it looks like.
// Henyey-Greenstein phase function, Fresnel border.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

namespace enamel::twin::testing {

struct Medium {
  double scatter = 16;   // 1 / mm
  double g = 0.68;       // mean cosine
  double absorb = 0.06;  // 1 / mm
  double index = 1.63;
};

inline constexpr std::array<double, 4> kPeriodsMm{4, 2, 1, 0.5};
inline const double kLightAngle = 12 * std::numbers::pi / 180;

struct FringeResponse {
  std::array<double, 4> mtf{}, depth_mm{};  // by kPeriodsMm; depth as triangulation sees it
};

/// Photons on their way through the half space; x, y along its surface, z into it.
class PhotonWalk {
 public:
  struct Way {
    double x, y, z, ux, uy, uz;
  };
  /// A direction outside by its parts along the surface.
  struct Slant {
    double x = 0, y = 0;
  };

  PhotonWalk(const Medium& medium, std::uint64_t seed) : m_(medium), state_(seed) {}

  double uniform() {  // splitmix64
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
    return (static_cast<double>((z ^ (z >> 31U)) >> 11U) + 0.5) * 0x1p-53;
  }

  /// What of a scattering leaves towards `view` per projected area, and where along x: the expected value instead of
  /// waiting for it.
  struct Peeled {
    double leaves, x;
  };
  [[nodiscard]] Peeled peel(const Way& w, double weight, Slant view) const {
    const double vx = view.x / m_.index, vy = view.y / m_.index, up = std::sqrt(1 - vx * vx - vy * vy);
    const double turn = w.ux * vx + w.uy * vy - w.uz * up, g = m_.g;
    const double phase = (1 - g * g) / std::pow(1 + g * g - 2 * g * turn, 1.5);
    const double through = std::exp(-(m_.scatter + m_.absorb) * w.z / up) * (1 - fresnel(up));
    return {weight * phase * through / up, w.x + w.z * vx / up};
  }

  /// Follows one photon from `travel`, a direction outside; at each scattering calls at(way, weight).
  template <class At>
  void follow(Slant travel, const At& at) {
    Way w{0, 0, 0, travel.x / m_.index, travel.y / m_.index, 0};
    w.uz = std::sqrt(1 - w.ux * w.ux - w.uy * w.uy);
    double weight = 1;
    const double extinction = m_.scatter + m_.absorb;
    constexpr double kDeepMm = 12, kFaint = 0.02;
    while (w.z < kDeepMm) {
      double step = -std::log(uniform()) / extinction;
      if (w.z + w.uz * step < 0) {  // reflected inside; what leaves has been counted
        const double to_border = -w.z / w.uz;
        weight *= fresnel(-w.uz);
        advance(w, to_border);
        w.z = 0;
        w.uz = -w.uz;
        step -= to_border;
      }
      advance(w, step);
      weight *= m_.scatter / extinction;
      if (weight < kFaint) {
        if (uniform() > 0.1) return;
        weight *= 10;
      }
      at(w, weight);
      scatter(w);
    }
  }

 private:
  /// Unpolarised reflectance from inside.
  [[nodiscard]] double fresnel(double cosine) const {
    const double sine = m_.index * std::sqrt(std::max(0.0, 1 - cosine * cosine));
    if (sine >= 1) return 1;
    const double out = std::sqrt(1 - sine * sine), n = m_.index;
    const double s = (n * cosine - out) / (n * cosine + out), p = (n * out - cosine) / (n * out + cosine);
    return 0.5 * (s * s + p * p);
  }

  static void advance(Way& w, double step) {
    w.x += w.ux * step;
    w.y += w.uy * step;
    w.z += w.uz * step;
  }

  void scatter(Way& w) {
    const double g = m_.g, q = (1 - g * g) / (1 - g + 2 * g * uniform());
    const double c = (1 + g * g - q * q) / (2 * g), s = std::sqrt(std::max(0.0, 1 - c * c));
    const double phi = 2 * std::numbers::pi * uniform(), a = s * std::cos(phi), b = s * std::sin(phi);
    const double d = std::sqrt(std::max(1e-12, 1 - w.uz * w.uz));
    const Way was = w;
    w.ux = (was.ux * was.uz * a - was.uy * b) / d + was.ux * c;
    w.uy = (was.uy * was.uz * a + was.ux * b) / d + was.uy * c;
    w.uz = -a * d + was.uz * c;
  }

  Medium m_;
  std::uint64_t state_;
};

/// Light from 12 degrees, view within 30 degrees of the normal: as the table of the design has it.
class SlabPhotons {
 public:
  SlabPhotons(const Medium& medium, std::uint64_t seed) : walk_(medium, seed) {}

  FringeResponse run(int photons) {
    const auto peel = [&](const PhotonWalk::Way& w, double weight) { this->peel(w, weight); };
    for (int i = 0; i < photons; ++i) walk_.follow({std::sin(kLightAngle), 0}, peel);
    FringeResponse out;
    for (std::size_t k = 0; k < kPeriodsMm.size(); ++k) {
      out.mtf[k] = std::abs(sums_[k]) / total_;
      out.depth_mm[k] = std::arg(sums_[k]) * kPeriodsMm[k] / (2 * std::numbers::pi) / std::tan(kLightAngle);
    }
    return out;
  }

 private:
  void peel(const PhotonWalk::Way& w, double weight) {
    const double narrow = std::cos(30 * std::numbers::pi / 180);
    const double cosine = narrow + (1 - narrow) * walk_.uniform(), phi = 2 * std::numbers::pi * walk_.uniform();
    const double sine = std::sqrt(1 - cosine * cosine);
    const auto seen = walk_.peel(w, weight * cosine, {sine * std::cos(phi), sine * std::sin(phi)});
    total_ += seen.leaves;
    std::complex<double> fringe = std::polar(1.0, 2 * std::numbers::pi * seen.x / kPeriodsMm[0]);
    for (auto& sum : sums_) {
      sum += seen.leaves * fringe;
      fringe *= fringe;  // periods halve
    }
  }

  PhotonWalk walk_;
  double total_ = 0;
  std::array<std::complex<double>, 4> sums_{};
};

}  // namespace enamel::twin::testing
