// What a person is told of the sight: what most of the last bursts agree on, so that words do not flicker.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "pipeline/types/sight.hpp"

namespace enamel {

class SightVotes {
 public:
  /// The newest burst's sight with the trouble that at least half of the last bursts had, or kNone.
  [[nodiscard]] Sight add(const Sight& newest) noexcept {
    last_[next_++ % kBursts] = newest.trouble;
    const auto has_votes = [this](SightTrouble t) {
      return std::count(last_.begin(), last_.end(), t) >= static_cast<std::ptrdiff_t>(kBursts / 2);
    };
    Sight told = newest;
    told.trouble = SightTrouble::kNone;
    for (std::size_t t = 1; t < kSightTroubles; ++t) {
      if (has_votes(static_cast<SightTrouble>(t))) told.trouble = static_cast<SightTrouble>(t);
    }
    if (told.trouble == newest.trouble) place_ = newest;
    told.x_px = place_.x_px, told.y_px = place_.y_px;
    return told;
  }

 private:
  static constexpr std::size_t kBursts = 8;  ///< chosen: a quarter of a second at the probe's rate
  std::array<SightTrouble, kBursts> last_{};
  std::size_t next_ = 0;
  Sight place_;  ///< where it was seen last
};

}  // namespace enamel
