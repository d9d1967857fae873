// One pass of ICP over the samples: associate, judge, sum. The inner loop of registration, apart from its iteration.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/register/icp/normal_system.hpp"
#include "pipeline/register/icp/patch_samples.hpp"
#include "pipeline/register/icp/reference.hpp"
#include "pipeline/register/icp/view_camera.hpp"

namespace enamel::pipeline {

/// Median of |e| by counting (1 µm bins): no order of points can change it.
class ResidualHistogram {
 public:
  static constexpr std::int32_t kLastBin = 1023;
  static constexpr std::int32_t kNoBin = kLastBin + 1;  ///< of what is no residual

  void add(float abs_e_mm) {
    ++bins_[std::min(static_cast<std::size_t>(abs_e_mm * 1000.0F), static_cast<std::size_t>(kLastBin))];
    ++count_;
  }
  /// Bins of residuals, kNoBin among them.
  void add_bins(std::span<const std::int32_t> bins) {
    for (const std::int32_t bin : bins) {
      ++bins_[static_cast<std::size_t>(bin)];
      count_ += bin != kNoBin ? 1U : 0U;
    }
  }
  [[nodiscard]] double median_mm() const {
    std::size_t seen = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(kLastBin); ++i) {
      seen += bins_[i];
      if (2 * seen >= count_) return (static_cast<double>(i) + 0.5) * 1e-3;
    }
    return 0;
  }

 private:
  std::array<std::uint32_t, kNoBin + 1> bins_{};
  std::uint32_t count_ = 0;
};

/// Weight of a residual by its size. Welsch's exp(-r^2) is taken as (1 + r^2/4)^-4: no library call whose last bit
/// depends on the processor, and a tail that falls as fast as anything here needs.
struct RobustKernel {
  bool welsch = false;
  float inv_scale = 1;  ///< 1 / (tuning constant * robust standard deviation), 1/mm
  [[nodiscard]] float weight(float e) const {
    const float r = std::abs(e) * inv_scale;
    if (!welsch) return r <= 1.0F ? 1.0F : 1.0F / r;
    const float t = 1.0F / (1.0F + 0.25F * r * r);
    return (t * t) * (t * t);
  }
};

struct MatchGate {
  float distance_mm = 0;    ///< point to plane
  float distance3d_mm = 0;  ///< point to pixel: allows for the reference's pitch
  float min_cos = 0;        ///< between normals
  float hidden_mm = 0;      ///< so far behind the reference a sample does not contradict it: it was hidden there
};

struct AlignPass {
  NormalSystem system;
  ResidualHistogram residuals;
  double weight = 0;  ///< of matches, without the kernel
  double weighted_e2 = 0;
  std::size_t matches = 0;
  std::size_t contradictions = 0;  ///< fell on the reference, or before it, but do not agree with it
  [[nodiscard]] double rms_mm() const { return weight > 0 ? std::sqrt(weighted_e2 / weight) : 0; }
};

/// What is laid on what: the same in every pass of an alignment. Refers to its parts.
struct Alignment {
  const SampleSet& samples;
  const Reference& reference;
  const ViewCamera& camera;
  double rho_mm;  ///< lever of turns, so that they count in mm as shifts do
};

/// Motions are taken about T_model_cam * samples.centroid.
[[nodiscard]] AlignPass accumulate(const Alignment& of, const Pose& T_model_cam, const MatchGate& gate,
                                   const RobustKernel& kernel);

}  // namespace enamel::pipeline
