// Patterns of a calibration pose (mode multi): white and black, then four-step fringes from one period across the
// projector to the finest, along u and along v. A set is what one burst of four frames shows.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/twin/optics/projector.hpp"

namespace enamel::twin {

class MultiPatterns {
 public:
  /// cycles: periods across the projector, rising. mean, amplitude: 8-bit levels.
  MultiPatterns(const calib::Rig& rig, std::vector<int> cycles, double mean, double amplitude)
      : width_(rig.projector.width),
        height_(rig.projector.height),
        cycles_(std::move(cycles)),
        mean_(mean),
        amplitude_(amplitude) {}

  [[nodiscard]] int sets() const { return 1 + 2 * static_cast<int>(cycles_.size()); }

  /// Set 0: white, black, white, black. Sets 1 … n: fringes along u by rising cycles; n + 1 … 2n: along v. Frame k =
  /// mean + amplitude * cos(2 pi cycles i / pixels + k pi / 2), i the projector pixel. Needs 0 <= set < sets().
  [[nodiscard]] calib::PatternLevels levels(int set) const;

  /// File names of a set's frames in a calibration folder, without suffix: "v_16_0". Frames 2 and 3 of set 0 repeat
  /// the first two.
  [[nodiscard]] std::array<std::string, 4> names(int set) const;

  [[nodiscard]] const std::vector<int>& cycles() const { return cycles_; }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double amplitude() const { return amplitude_; }

 private:
  struct Fringe {
    bool along_v = false;
    int cycles = 1;
  };
  [[nodiscard]] Fringe fringe(int set) const;

  int width_, height_;
  std::vector<int> cycles_;
  double mean_, amplitude_;
};

}  // namespace enamel::twin
