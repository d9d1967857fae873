#include "tests/support/tooth_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calib/model/lens.hpp"

namespace enamel::test {
namespace {

constexpr double kMiddle_mm = 48, kJump_mm = 0.3, kPsf_px = 0.6;
constexpr int kPatch_px = 10, kPatches = 6, kStrip_px = 40;  ///< the strip at the lower border that holds the patches
constexpr int kBeside_px = 128;  ///< how far a shadow reaches: 7 mm high, the light 22 degrees off the view

/// Uniform numbers from SplitMix64.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double operator()(double low, double high) {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15U);
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return low + (high - low) * static_cast<double>((z ^ (z >> 31U)) >> 11U) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_;
};

struct Tooth {
  double x_mm = 0, y_mm = 0, half_width_mm = 0, half_height_mm = 0, rise_mm = 0, rounding = 0, cusp_mm = 0;
  double contrast = 0;
  bool one_fringe = false, dark_gap = false;
  double gap_mm = 0;  ///< to the next tooth
};

/// Share of the way from the middle to the outline: below 1 inside.
double reach(const Tooth& t, double x, double y) {
  const double dx = (x - t.x_mm) / t.half_width_mm, dy = (y - t.y_mm) / t.half_height_mm;
  return std::sqrt(std::sqrt(dx * dx * dx * dx + dy * dy * dy * dy));
}

class Builder {
 public:
  Builder(const calib::Rig& rig, std::uint64_t seed)
      : rig_(rig),
        random_(seed),
        width_(rig.camera.width),
        height_(rig.camera.height),
        mm_per_px_(kMiddle_mm / rig.camera.fx) {
    out_.depth_mm = out_.light = out_.contrast = Map<double>(width_, height_);
    out_.near_jump = Map<std::uint8_t>(width_, height_);
  }

  ToothSteps build() {
    place_teeth();
    raise();
    add_patches();
    cast_shadows();
    mark_jumps();
    return std::move(out_);
  }

 private:
  void place_teeth() {
    const double field_mm = width_ * mm_per_px_, middle_mm = 0.5 * (height_ - kStrip_px) * mm_per_px_;
    double x = random_(-2, 1);
    while (x < field_mm) {
      Tooth t;
      t.half_width_mm = random_(1.5, 3);
      t.half_height_mm = random_(0.55, 0.95) * middle_mm;
      t.x_mm = x + t.half_width_mm, t.y_mm = middle_mm + random_(-0.5, 0.5);
      t.one_fringe = teeth_.empty();
      t.rise_mm = random_(1, 7), t.rounding = random_(0, 0.5), t.cusp_mm = random_(0, 0.25);
      t.contrast = random_(0.1, 0.8);
      t.gap_mm = random_(0.3, 2), t.dark_gap = random_(0, 1) < 0.5;
      x = t.x_mm + t.half_width_mm + t.gap_mm;
      teeth_.push_back(t);
    }
    // Any place in the row may be that of the tooth of one fringe, as long as it is in view.
    if (teeth_.size() > 1)
      std::swap(teeth_[0].one_fringe, teeth_[static_cast<std::size_t>(random_(0, 1.999))].one_fringe);
  }

  void raise() {
    gum_mm_ = random_(50.5, 53), gum_contrast_ = random_(0.15, 0.5), a_ = random_(0, 6), b_ = random_(0, 6);
    for (int v = 0; v < height_; ++v) {
      for (int u = 0; u < width_; ++u) {
        const double x = u * mm_per_px_, y = v * mm_per_px_;
        const Tooth* tooth = nullptr;
        out_.depth_mm(u, v) = surface(u, v, tooth);
        out_.light(u, v) = in_dark_gap(x, y) ? 0 : 0.85 + 0.15 * std::sin(0.5 * x + b_) * std::cos(0.6 * y + a_);
        const double contrast = tooth ? tooth->contrast : gum_contrast_;
        out_.contrast(u, v) = std::max(0.1, contrast * (1 + 0.15 * std::sin(1.7 * x) * std::sin(1.1 * y)));
      }
    }
  }

  /// Depth of the teeth and the gum, beyond the picture, too; `tooth` is the one that is hit, if any.
  double surface(int u, int v, const Tooth*& tooth) const {
    const double x = u * mm_per_px_, y = v * mm_per_px_;
    const double gum = gum_mm_ + 0.25 * std::sin(0.9 * x + a_) + 0.2 * std::sin(1.3 * y + b_);
    double z = gum;
    for (const Tooth& t : teeth_) {
      const double r = reach(t, x, y);
      if (r >= 1) continue;
      z = t.one_fringe ? a_fringe_nearer(u, v, gum) : gum - height_of(t, r, x, y);
      tooth = &t;
    }
    return z;
  }

  bool in_dark_gap(double x, double y) const {
    return std::any_of(teeth_.begin(), teeth_.end(), [&](const Tooth& t) {
      const double past = x - t.x_mm - t.half_width_mm;
      return t.dark_gap && past > 0 && past < t.gap_mm && std::abs(y - t.y_mm) < t.half_height_mm;
    });
  }

  static double height_of(const Tooth& t, double r, double x, double y) {
    return t.rise_mm * (1 - t.rounding * r * r * r * r) +
           t.cusp_mm * std::cos(2.5 * (x - t.x_mm)) * std::cos(2.5 * (y - t.y_mm));
  }

  double column(int u, int v, double z_mm) const {
    const calib::PlanePoint ray = calib::undistort(rig_.camera, {static_cast<double>(u), static_cast<double>(v)});
    return calib::project_to_projector(rig_, ray, z_mm).x;
  }

  /// Depth nearer to the camera at which the pixel sees exactly the next fringe: the phase does not show the jump.
  double a_fringe_nearer(int u, int v, double z_mm) const {
    const double from = column(u, v, z_mm), period = rig_.patterns.period_px;
    double z0 = z_mm, z1 = z_mm - 3, miss0 = -period;
    for (int k = 0; k < 5; ++k) {  // secant in 1/z, in which the projector's column is nearly affine
      const double miss = std::abs(column(u, v, z1) - from) - period;
      if (miss == miss0) break;
      const double q = 1 / z1 - miss * (1 / z1 - 1 / z0) / (miss - miss0);
      z0 = z1, miss0 = miss, z1 = 1 / q;
    }
    return z1;
  }

  void add_patches() {
    for (int v = height_ - kStrip_px; v < height_; ++v)
      for (int u = 0; u < width_; ++u) out_.light(u, v) = 0, out_.depth_mm(u, v) = kMiddle_mm;
    for (int k = 0; k < kPatches; ++k) {
      const int u0 = static_cast<int>((k + random_(0.1, 0.7)) * width_ / kPatches),
                v0 = height_ - kStrip_px + 10 + static_cast<int>(random_(0, 15));
      const double z = random_(41, 55), contrast = random_(0.15, 0.8);
      for (int v = v0; v < v0 + kPatch_px; ++v) {
        for (int u = u0; u < std::min(width_, u0 + kPatch_px); ++u) {
          out_.depth_mm(u, v) = z + 0.01 * (u - u0), out_.light(u, v) = 0.9, out_.contrast(u, v) = contrast;
        }
      }
    }
  }

  /// A buffer of least depths over the projector's columns, row by row: what lies behind another part of the row, in
  /// view or beside it, is dark.
  void cast_shadows() {
    const auto columns = static_cast<std::size_t>(rig_.projector.width) + 2;
    std::vector<double> nearest(columns), at(static_cast<std::size_t>(width_));
    const auto bin = [&](double x) {
      return static_cast<std::size_t>(std::clamp(x + 1, 0.0, static_cast<double>(columns - 1)));
    };
    for (int v = 0; v < height_ - kStrip_px; ++v) {
      std::fill(nearest.begin(), nearest.end(), std::numeric_limits<double>::max());
      double last_z = std::numeric_limits<double>::max(), last_x = 0;
      for (int u = -kBeside_px; u < width_ + kBeside_px; ++u) {
        const bool seen = u >= 0 && u < width_;
        const Tooth* tooth = nullptr;
        const double z = seen ? out_.depth_mm(u, v) : surface(u, v, tooth), x = column(u, v, z);
        if (seen) at[static_cast<std::size_t>(u)] = x;
        const double before = std::abs(z - last_z) < kJump_mm ? last_x : x;
        for (std::size_t b = bin(std::min(before, x)); b <= bin(std::max(before, x)); ++b)
          nearest[b] = std::min(nearest[b], z);
        last_z = z, last_x = x;
      }
      for (int u = 0; u < width_; ++u)
        if (out_.depth_mm(u, v) > nearest[bin(at[static_cast<std::size_t>(u)])] + kJump_mm) out_.light(u, v) = 0;
    }
  }

  void mark_jumps() {
    for (int v = 0; v < height_ - kStrip_px; ++v) {
      for (int u = 0; u + 1 < width_; ++u) {
        const double z = out_.depth_mm(u, v);
        const bool along = std::abs(out_.depth_mm(u + 1, v) - z) > kJump_mm;
        const bool down = v + 1 < height_ - kStrip_px && std::abs(out_.depth_mm(u, v + 1) - z) > kJump_mm;
        if (along || down) mark_around(u, v);
      }
    }
  }

  void mark_around(int u0, int v0) {
    for (int v = std::max(0, v0 - kJumpBand_px); v <= std::min(height_ - 1, v0 + kJumpBand_px); ++v) {
      for (int u = std::max(0, u0 - kJumpBand_px); u <= std::min(width_ - 1, u0 + kJumpBand_px); ++u)
        out_.near_jump(u, v) = 1;
    }
  }

  const calib::Rig& rig_;
  Random random_;
  int width_, height_;
  double mm_per_px_;
  std::vector<Tooth> teeth_;
  double gum_mm_ = 0, gum_contrast_ = 0, a_ = 0, b_ = 0;  ///< its waves begin at a and b
  ToothSteps out_;
};

}  // namespace

SceneOptions ToothSteps::options(std::uint64_t noise_seed) const {
  SceneOptions o;
  o.noise = true, o.seed = noise_seed;
  o.mean_dn = o.modulation_dn = 125;
  o.psf_px = kPsf_px;
  o.light = [this](int u, int v) { return light(u, v); };
  o.contrast = [this](int u, int v) { return contrast(u, v); };
  return o;
}

ToothSteps make_tooth_steps(const calib::Rig& rig, std::uint64_t seed) { return Builder(rig, seed).build(); }

}  // namespace enamel::test
