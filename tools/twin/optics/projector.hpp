// Projector: pattern levels -> look-up table -> DMD response -> blur that grows with defocus. Patterns vary along one
// projector axis only, so the blurred image is a table over (axis coordinate, blur variance).
#pragma once

#include <array>
#include <vector>

#include "calib/model/pattern.hpp"

namespace enamel::twin {

struct ProjectorConfig {
  bool round_levels = true;         ///< pattern levels are 8-bit integers
  double gamma = 2.2;               ///< emission ~ level^gamma
  double lut_gamma = 2.2;           ///< exponent that the inverse look-up table assumes; its output is rounded to 8 bit
  double black_fraction = 0.002;    ///< emission of level 0 relative to level 255
  double blur_sigma_px = 0.7;       ///< Gaussian at best focus
  double defocus_px_per_mm = 0.25;  ///< added in quadrature: slope * (z_p - focus)
  double focus_mm = 49.0;           ///< in projector coordinates
  double spread_mm = 0;             ///< widest spread of its light inside a body; 0: bodies scatter at their surface
};

/// Emission 0…1 of a commanded level, through table and response.
[[nodiscard]] double emission_of_level(const ProjectorConfig& config, double level);

class ProjectorLight {
 public:
  /// spread_px: widest spread inside a body that blurred() is asked for; 0: it is not.
  ProjectorLight(const calib::PatternLevels& levels, const ProjectorConfig& config, double near_mm, double far_mm,
                 double spread_px = 0);

  [[nodiscard]] double sigma2_at(double z_p) const {
    const double d = config_.defocus_px_per_mm * (z_p - config_.focus_mm);
    return config_.blur_sigma_px * config_.blur_sigma_px + d * d;
  }

  /// Where a (coordinate, variance) falls in the tables; shared by the four frames.
  struct Tap {
    std::size_t index = 0;
    float fu = 0, fs = 0;
  };
  /// p: coordinate along the pattern axis, px, inside the frame.
  [[nodiscard]] Tap tap(double p, double sigma2) const {
    const double x = (p + kMargin) * kFine;
    const auto ix = static_cast<std::size_t>(x);
    double b = (sigma2 - sigma2_min_) * bins_per_unit_;
    b = b < 0 ? 0 : (b > bin_limit_ ? bin_limit_ : b);
    const auto ib = static_cast<std::size_t>(b);
    return {ib * stride_ + ix, static_cast<float>(x - static_cast<double>(ix)),
            static_cast<float>(b - static_cast<double>(ib))};
  }
  /// Emission relative to level 255 for any variance up to the spread's and any coordinate; outside the frame there is
  /// no light but what blurs over its border.
  [[nodiscard]] float blurred(int frame, double p, double sigma2) const;
  /// Emission relative to level 255 in frame `frame`.
  [[nodiscard]] float emission(int frame, const Tap& t) const {
    const float* a = tables_[static_cast<std::size_t>(frame)].data() + t.index;
    const float* b = a + stride_;
    const float lo = a[0] + t.fu * (a[1] - a[0]);
    const float hi = b[0] + t.fu * (b[1] - b[0]);
    return lo + t.fs * (hi - lo);
  }
  [[nodiscard]] bool axis_v() const { return axis_v_; }

 private:
  void fill(int frame, std::size_t bin, double sigma, const std::vector<double>& emission);

  static constexpr double kFine =
      64;  ///< table points a projector pixel: linear interpolation to 1e-5 of the amplitude
  static constexpr double kMargin = 2;                                     ///< px before the frame
  static constexpr double kWideFine = 4, kWideMargin = 16, kWideBins = 8;  ///< places a px; px; bins an octave
  ProjectorConfig config_;
  bool axis_v_;
  double sigma2_min_ = 0, bins_per_unit_ = 0, bin_limit_ = 0;
  std::size_t stride_ = 0, bins_ = 0;
  std::array<std::vector<float>, 4> tables_;

  /// Tables of wide blurs: bins by octaves of the variance, coarse in place.
  struct Wide {
    double first = 0, bin_limit = 0;
    std::size_t stride = 0, bins = 0;
    std::array<std::vector<float>, 4> tables;  // [bin][place]
  };
  void fill_wide(double sigma2_max, const std::array<std::vector<double>, 4>& emission);
  std::size_t pixels_ = 0;
  double sigma2_top_ = 0;  // of the fine tables
  Wide wide_;
};

}  // namespace enamel::twin
