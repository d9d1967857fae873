#include "tests/support/draw/exposure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/support/draw/random.hpp"

namespace enamel::test {
namespace {

/// Two samples of a pixel and two instants of an exposure that have the mean and the variance of an even spread.
constexpr double kSpread = 0.28867513459481287;
constexpr double kSmooth_mm = 0.1;  ///< neighbours of one face whose depths differ by less are interpolated between

/// What all pixel centres see at one instant.
class Instant {
 public:
  Instant(const Stage& stage, double time_s)
      : stage_(stage),
        tracer_(stage.drawn, *stage.shape, time_s),
        width_(stage.drawn.rig.camera.width),
        height_(stage.drawn.rig.camera.height),
        rough_(width_, height_) {
    points_.reserve(stage.rays.size());
    for (const auto& ray : stage.rays) points_.push_back(tracer_.trace(ray));
    for (int v = 0; v < height_; ++v) {
      for (int u = 0; u < width_; ++u) {
        if (u + 1 < width_ && !alike(at(u, v), at(u + 1, v))) mark(u, v - 1, u + 1, v + 1);
        if (v + 1 < height_ && !alike(at(u, v), at(u, v + 1))) mark(u - 1, v, u + 1, v + 1);
      }
    }
  }

  const TracedPoint& at(int u, int v) const {
    return points_[static_cast<std::size_t>(std::clamp(v, 0, height_ - 1)) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(std::clamp(u, 0, width_ - 1))];
  }

  /// Whether a pixel and its eight neighbours lie on one smooth surface, all in light or all in shadow.
  bool smooth(int u, int v) const { return rough_(u, v) == 0; }

  /// Share of full well that frame `frame` brings to a smooth pixel. diagonal: +1 or -1, along which the samples lie.
  double smooth_signal(int frame, int u, int v, double diagonal) const {
    const TracedPoint& p = at(u, v);
    if (!p.lit) return p.ambient;
    const double du = slope(at(u - 1, v), at(u + 1, v), u > 0 && u + 1 < width_);
    const double dv = slope(at(u, v - 1), at(u, v + 1), v > 0 && v + 1 < height_);
    const double off = kSpread * (du + diagonal * dv);
    const Emission& e = stage_.emission;
    return p.ambient +
           0.5 * p.light *
               (e(frame, p.column_px + off, p.projector_depth_mm) + e(frame, p.column_px - off, p.projector_depth_mm));
  }

  /// The same where surfaces, paint or shadows have their edge: four rays of its own.
  double edge_signal(int frame, int u, int v) const {
    const calib::LensValues& lens = stage_.drawn.rig.camera;
    const calib::PlanePoint& centre =
        stage_.rays[static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u)];
    double sum = 0;
    for (int n = 0; n < 4; ++n) {
      const double du = n % 2 == 0 ? -0.25 : 0.25, dv = n / 2 == 0 ? -0.25 : 0.25;
      const TracedPoint p = tracer_.trace({centre.x + du / lens.fx, centre.y + dv / lens.fy});
      sum += p.ambient;
      if (p.lit) sum += p.light * stage_.emission(frame, p.column_px, p.projector_depth_mm);
    }
    return 0.25 * sum;
  }

 private:
  static double slope(const TracedPoint& a, const TracedPoint& b, bool both) {
    return (b.column_px - a.column_px) * (both ? 0.5 : 1);
  }

  static bool alike(const TracedPoint& a, const TracedPoint& b) {
    return a.face == b.face && a.lit == b.lit && std::abs(a.depth_mm - b.depth_mm) < kSmooth_mm;
  }

  void mark(int u0, int v0, int u1, int v1) {
    for (int v = std::max(0, v0); v <= std::min(height_ - 1, v1); ++v)
      for (int u = std::max(0, u0); u <= std::min(width_ - 1, u1); ++u) rough_(u, v) = 1;
  }

  const Stage& stage_;
  Tracer tracer_;
  int width_, height_;
  Map<std::uint8_t> rough_;
  std::vector<TracedPoint> points_;
};

/// Separable Gaussian on the pixel grid, values beyond the border as on it.
void blur(Map<float>& image, double sigma_px) {
  const int w = image.width(), h = image.height(), reach = static_cast<int>(std::ceil(4 * sigma_px));
  std::vector<float> weight;
  double total = 0;
  for (int j = -reach; j <= reach; ++j) total += std::exp(-0.5 * j * j / (sigma_px * sigma_px));
  for (int j = -reach; j <= reach; ++j)
    weight.push_back(static_cast<float>(std::exp(-0.5 * j * j / (sigma_px * sigma_px)) / total));
  Map<float> across(w, h);
  for (int v = 0; v < h; ++v) {
    for (int j = -reach; j <= reach; ++j) {
      const float f = weight[static_cast<std::size_t>(j + reach)];
      for (int u = 0; u < w; ++u) across(u, v) += f * image(std::clamp(u + j, 0, w - 1), v);
    }
  }
  image = Map<float>(w, h);
  for (int v = 0; v < h; ++v) {
    for (int j = -reach; j <= reach; ++j) {
      const float f = weight[static_cast<std::size_t>(j + reach)];
      const int from = std::clamp(v + j, 0, h - 1);
      for (int u = 0; u < w; ++u) image(u, v) += f * across(u, from);
    }
  }
}

}  // namespace

std::vector<calib::PlanePoint> pixel_rays(const calib::LensValues& camera) {
  std::vector<calib::PlanePoint> out;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u)
      out.push_back(calib::undistort(camera, {static_cast<double>(u), static_cast<double>(v)}));
  }
  return out;
}

Stage::Stage(const Drawn& of) : drawn(of), shape(make_shape(of.scene)), emission(of), rays(pixel_rays(of.rig.camera)) {}

namespace {

FrameLight expose(const Stage& stage, int frame, const Instant& before, const Instant& after) {
  const int w = stage.drawn.rig.camera.width, h = stage.drawn.rig.camera.height;
  FrameLight out{Map<float>(w, h), Map<double>(w, h, std::numeric_limits<double>::quiet_NaN())};
  for (int v = 0; v < h; ++v) {
    for (int u = 0; u < w; ++u) {
      const bool first = before.smooth(u, v), second = after.smooth(u, v);
      const double a = first ? before.smooth_signal(frame, u, v, 1) : before.edge_signal(frame, u, v);
      const double b = second ? after.smooth_signal(frame, u, v, -1) : after.edge_signal(frame, u, v);
      out.signal(u, v) = static_cast<float>(0.5 * (a + b));
      const TracedPoint &p = before.at(u, v), &q = after.at(u, v);
      if (first && second && p.lit && q.lit) out.column_px(u, v) = 0.5 * (p.column_px + q.column_px);
    }
  }
  blur(out.signal, stage.drawn.optics.psf_px);
  return out;
}

}  // namespace

std::array<FrameLight, 4> expose(const Stage& stage, double later_s, const std::array<bool, 4>& taken) {
  const double apart_s = kSpread * kExposure_s;
  std::array<FrameLight, 4> out;
  std::optional<Instant> still;
  if (stage.drawn.motion.is_still()) still.emplace(stage, 0.0);
  for (std::size_t k = 0; k < 4; ++k) {
    if (!taken[k]) continue;
    const int frame = static_cast<int>(k);
    const double time_s = later_s + (frame - 1.5) * kFrameInterval_s;
    out[k] = still ? expose(stage, frame, *still, *still)
                   : expose(stage, frame, Instant(stage, time_s - apart_s), Instant(stage, time_s + apart_s));
  }
  return out;
}

std::vector<std::uint8_t> read_out(const Drawn& drawn, const Map<float>& signal, double gain, std::uint64_t noise) {
  constexpr double kFewElectrons = 30;  // from here on a Gaussian does for shot noise
  constexpr std::uint64_t kOfPixels = 100, kOfFrames = 101;
  Random unit(drawn.seed, kOfPixels), random(drawn.seed, kOfFrames + noise);
  const calib::NoiseValues& n = *drawn.rig.noise;
  std::vector<std::uint8_t> out;
  out.reserve(signal.size());
  for (const float share : signal.pixels()) {
    const double pixel_gain = drawn.optics.prnu > 0 ? 1 + drawn.optics.prnu * unit.normal() : 1;
    const double mean_e = std::max(0.0, static_cast<double>(share) * gain * pixel_gain * n.full_well_e);
    double electrons = 0;
    if (mean_e < kFewElectrons) {
      electrons = random.poisson(mean_e) + n.read_noise_e * random.normal();
    } else if (mean_e < 0.9 * n.full_well_e) {
      electrons = mean_e + std::sqrt(mean_e + n.read_noise_e * n.read_noise_e) * random.normal();
    } else {
      electrons = std::min(n.full_well_e, mean_e + std::sqrt(mean_e) * random.normal());
      electrons += n.read_noise_e * random.normal();
    }
    const double dn = n.black_dn + electrons / n.gain_e_per_dn;
    out.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(dn), 0L, 255L)));
  }
  return out;
}

}  // namespace enamel::test
