// Simulated light whose pixels say which burst and which pattern they are: what an association must not mix up.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "firmware/device/sim/burst_source.hpp"

namespace enamel::fw::test {

inline constexpr std::int64_t kPeriodNs = 4'004'000;
inline constexpr int kTagWidth = 16;
inline constexpr int kTagHeight = 2;
inline constexpr std::uint8_t kTagLevel = 100;

/// Burst index and pattern of a frame made by TaggedSource; nullopt for one without light.
inline std::optional<std::pair<std::uint64_t, int>> tag_of(std::span<const std::uint8_t> pixels) {
  if (pixels.size() < 9 || pixels.back() < kTagLevel) return std::nullopt;
  std::uint64_t index = 0;
  std::memcpy(&index, pixels.data(), 8);
  return std::pair(index, static_cast<int>(pixels[8]));
}

class TaggedSource final : public BurstSource {
 public:
  struct Config {
    std::uint64_t count = 10;
    std::int64_t start_ns = 5'000'000'000;
    std::vector<std::int64_t> distances_ns{33'333'333};  ///< taken in turn
    std::uint64_t first_index = 0;
    std::vector<std::uint32_t> exposures_us{3700};  ///< taken in turn
  };
  explicit TaggedSource(Config config) : config_(std::move(config)), t_(config_.start_ns) {}

  [[nodiscard]] const std::string& rig_text() const override { return rig_; }
  [[nodiscard]] std::optional<std::uint64_t> count() const override { return config_.count; }
  [[nodiscard]] Result<std::optional<SimBurst>> next() override {
    if (made_ == config_.count) return std::optional<SimBurst>{};
    SimBurst b;
    b.burst_index = config_.first_index + made_;
    b.exposure_us = config_.exposures_us[made_ % config_.exposures_us.size()];
    b.temp_c = 32.25;
    b.width = kTagWidth;
    b.height = kTagHeight;
    for (int k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(k);
      b.t_exposure_ns[i] = t_ + k * kPeriodNs;
      b.frames[i].assign(static_cast<std::size_t>(kTagWidth * kTagHeight),
                         static_cast<std::uint8_t>(kTagLevel + 10 * k));
      std::memcpy(b.frames[i].data(), &b.burst_index, 8);
      b.frames[i][8] = static_cast<std::uint8_t>(k);
    }
    t_ += config_.distances_ns[made_ % config_.distances_ns.size()];
    ++made_;
    return std::optional(std::move(b));
  }

 private:
  Config config_;
  std::string rig_ = "{\"format\": \"rig/1\"}";
  std::int64_t t_;
  std::uint64_t made_ = 0;
};

}  // namespace enamel::fw::test
