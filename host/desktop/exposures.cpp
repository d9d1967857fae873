#include "host/desktop/exposures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace enamel::host {
namespace {

constexpr double kClipped = 0.97;       // of full scale, as the decoder's `saturation`
constexpr double kMostOfPeriod = 0.95;  // the rest is for reading out
constexpr double kLeastGain = 1.5;      // less light than that more is no other exposure
constexpr double kSameExposure = 0.05;  // a camera counts in lines, of some 10 us

/// Level of pixel i, 255 at full scale.
class Levels {
 public:
  explicit Levels(const proto::Burst& burst)
      : is_wide_(burst.bit_depth > 8), scale_(255.0 / (std::ldexp(1.0, burst.bit_depth) - 1.0)) {
    for (int k = 0; k < proto::kFramesPerBurst; ++k)
      frames_[static_cast<std::size_t>(k)] = proto::frame_bytes(burst, k);
  }
  [[nodiscard]] double at(std::size_t frame, std::size_t i) const {
    const auto& bytes = frames_[frame];
    if (!is_wide_) return scale_ * bytes[i];
    return scale_ * (bytes[2 * i] + 256.0 * bytes[2 * i + 1]);
  }

 private:
  std::array<std::span<const std::uint8_t>, proto::kFramesPerBurst> frames_;
  bool is_wide_;
  double scale_;
};

}  // namespace

LightShares light_shares(const proto::Burst& burst, const ExposureConfig& config) {
  const Levels levels(burst);
  const std::size_t pixels = std::size_t{burst.width} * burst.height;
  std::size_t lit = 0, glare = 0, dim = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    double high = 0, low = 255;
    for (std::size_t k = 0; k < proto::kFramesPerBurst; ++k) {
      const double level = levels.at(k, i);
      high = std::max(high, level);
      low = std::min(low, level);
    }
    const bool is_clipped = high >= kClipped * 255;
    if (!is_clipped && high - low <= config.seen_levels) continue;
    ++lit;
    glare += is_clipped ? 1U : 0U;
    dim += !is_clipped && high - low < config.sound_levels ? 1U : 0U;
  }
  if (lit == 0) return {};
  const auto of = static_cast<double>(lit);
  return {static_cast<double>(glare) / of, static_cast<double>(dim) / of};
}

std::vector<std::uint32_t> further_exposures(const proto::Burst& first, const ExposureConfig& config) {
  std::vector<std::uint32_t> out;
  if (config.exposures == 1) return out;
  const double own_us = first.meta.front().exposure_us;
  const LightShares shares = config.exposures == 0 ? light_shares(first, config) : LightShares{};
  if (config.exposures >= 2 || shares.glare >= config.min_glare)
    out.push_back(static_cast<std::uint32_t>(std::lround(own_us / config.ratio)));
  const double most_us = kMostOfPeriod * 1e6 * proto::frame_period_s(first);
  const double longer_us = std::min(own_us * config.ratio, most_us);
  if (longer_us >= kLeastGain * own_us && (config.exposures >= 3 || shares.dim >= config.min_dim))
    out.push_back(static_cast<std::uint32_t>(std::floor(longer_us)));
  return out;
}

bool is_exposed(const proto::Burst& burst, std::uint32_t exposure_us) noexcept {
  const double is_us = burst.meta.front().exposure_us;
  return std::abs(is_us - exposure_us) <= kSameExposure * exposure_us + 1;
}

}  // namespace enamel::host
