// A decoded burst of a drawn scene against its truth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "pipeline/decode/burst_decoder.hpp"
#include "tests/support/draw/render.hpp"

namespace enamel::test {

/// Depth errors over predicted sigma.
class ZScores {
 public:
  void add(double z);
  ZScores& operator+=(const ZScores& o);

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Root of the mean square of what lies within kMostZ, once more; 0 of nothing.
  [[nodiscard]] double rms() const;
  /// Standard deviation that a Gaussian of the same median |z| has.
  [[nodiscard]] double by_median() const;
  [[nodiscard]] double mean() const;

 private:
  static constexpr double kMostZ = 6;
  static constexpr int kBins = 300;
  std::size_t count_ = 0, within_ = 0;
  double sum_ = 0, squares_ = 0;
  std::array<std::size_t, kBins + 1> bins_{};  ///< of |z|, the last beyond kMostZ
};

enum class PixelKind : std::uint8_t { kSmooth, kNearEdge, kMoving, kWeak };
inline constexpr std::size_t kPixelKinds = 4;
inline constexpr std::array<std::string_view, kPixelKinds> kPixelKindNames = {"smooth", "near edges", "moving", "weak"};
inline constexpr double kWeak_rad = 0.08, kSure_rad = 0.15;  ///< true phase noise above and below
inline constexpr double kTrueBurst_rad = 0.25, kTrueBurstShare = 0.2;
inline constexpr std::size_t kLargeWrongRegion_px = 100;

/// Pixels but for what says otherwise; of a rejected burst nothing is covered.
struct Judged {
  pipeline::BurstVerdict verdict = pipeline::BurstVerdict::kFrameMismatch;
  std::size_t lit = 0, covered = 0;                      ///< lit and inside the depth range; with a depth
  std::size_t sure = 0, sure_covered = 0;                ///< of these: true phase noise below kSure_rad
  std::size_t placed = 0, wrong = 0, largest_wrong = 0;  ///< with a depth on the object; half a period off and more
  std::size_t in_shadow = 0, off_object = 0;
  std::size_t smooth = 0, misled = 0;  ///< placed away from edges; of these further off than 3 sigma and 50 um
  double fastest_rad_a_frame = 0;
  std::array<ZScores, kPixelKinds> z;  ///< of what is placed, lit and right; kMoving, kWeak: away from edges

  [[nodiscard]] bool accepted() const { return verdict == pipeline::BurstVerdict::kAccepted; }
  /// Whether a decoder has to take it: slow enough, with enough light.
  [[nodiscard]] bool is_true_burst() const {
    return fastest_rad_a_frame <= kTrueBurst_rad &&
           static_cast<double>(sure) >= kTrueBurstShare * static_cast<double>(lit) && lit > 0;
  }
  [[nodiscard]] double coverage() const { return share(sure_covered, sure); }
  [[nodiscard]] double wrong_share() const { return share(wrong, placed); }
  [[nodiscard]] double misled_share() const { return share(misled, smooth); }

  [[nodiscard]] static double share(std::size_t part, std::size_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
  }
};

[[nodiscard]] Judged judge(const Drawn& drawn, const DrawnTruth& truth, const pipeline::DecodedBurst& decoded);

}  // namespace enamel::test
