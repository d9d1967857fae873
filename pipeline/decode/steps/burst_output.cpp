#include "pipeline/decode/steps/burst_output.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "pipeline/decode/phase/poly_trig.hpp"

namespace enamel::pipeline {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

template <class T>
void fill(Map<T>& map, const T& value) {
  std::fill(map.pixels().begin(), map.pixels().end(), value);
}

}  // namespace

void resize_output(int w, int h, DecodedBurst& out) {
  if (out.phase_rad.width() == w && out.phase_rad.height() == h) return;
  for (Map<float>* m :
       {&out.phase_rad, &out.patch.depth_mm, &out.patch.sigma_mm, &out.patch.texture_dn, &out.patch.modulation_dn})
    *m = Map<float>::unfilled(w, h);
  out.order = Map<std::uint8_t>::unfilled(w, h);
  out.reject = Map<PixelReject>::unfilled(w, h);
  for (Map<Vec3f>* m : {&out.patch.points, &out.patch.normals}) *m = Map<Vec3f>::unfilled(w, h);
}

void copy_images(const PhaseMaps& maps, const NoiseModel& noise, DecodedBurst& out) {
  const float black = noise.black_dn;
  const float* __restrict mean = maps.mean_dn.pixels().data(), * __restrict from = maps.modulation_dn.pixels().data();
  float* __restrict texture = out.patch.texture_dn.pixels().data();
  float* __restrict modulation = out.patch.modulation_dn.pixels().data();
  for (std::size_t i = 0; i < maps.mean_dn.size(); ++i) {
    texture[i] = mean[i] - black;
    modulation[i] = from[i];
  }
}

void show_anew(const RefinedPhase& phase, const NoiseModel& noise, DecodedBurst& out) {
  for (const std::size_t i : phase.solved_anew) {
    out.patch.texture_dn[i] = phase.maps.mean_dn[i] - noise.black_dn;
    out.patch.modulation_dn[i] = phase.maps.modulation_dn[i];
  }
}

void show_phase(const PhaseMaps& maps, DecodedBurst& out) {
  for (std::size_t i = 0; i < maps.phase_rad.size(); ++i) {
    const PixelReject r = maps.reject[i];
    const bool none = (r == PixelReject::kDark) | (r == PixelReject::kSaturated) | (r == PixelReject::kNoisy);
    const float phase = maps.phase_rad[i];
    out.phase_rad[i] = select(none, kNan, select(phase >= kPiF, -kPiF, phase));
    out.reject[i] = r;
  }
}

void show_nothing(DecodedBurst& out) {
  fill(out.reject, PixelReject::kDark);
  for (Map<float>* m : {&out.phase_rad, &out.patch.texture_dn, &out.patch.modulation_dn}) fill(*m, kNan);
}

void withdraw_surface(DecodedBurst& out) {
  for (Map<float>* m : {&out.patch.depth_mm, &out.patch.sigma_mm}) fill(*m, kNan);
  for (Map<Vec3f>* m : {&out.patch.points, &out.patch.normals}) fill<Vec3f>(*m, Vec3f::Constant(kNan));
  fill(out.order, kNoOrder);
  for (PixelReject& r : out.reject.pixels()) r = r == PixelReject::kNone ? PixelReject::kRelative : r;
}

std::size_t count_of(const Map<PixelReject>& reject, PixelReject reason) noexcept {
  // layout: what a byte counts up to; sums of bytes fill whole registers.
  constexpr std::size_t kLanes = 32, kMostSteps = 255;
  const PixelReject* __restrict pixels = reject.pixels().data();
  std::size_t total = 0, i = 0;
  while (i + kLanes <= reject.size()) {
    const std::size_t end = std::min(reject.size() - kLanes, i + (kMostSteps - 1) * kLanes);
    std::array<std::uint8_t, kLanes> counts{};
    for (; i <= end; i += kLanes) {
      for (std::size_t j = 0; j < kLanes; ++j)
        counts[j] = static_cast<std::uint8_t>(counts[j] + (pixels[i + j] == reason ? 1 : 0));
    }
    total = std::accumulate(counts.begin(), counts.end(), total);
  }
  for (; i < reject.size(); ++i) total += pixels[i] == reason ? 1U : 0U;
  return total;
}

void count_rejects(DecodedBurst& out) {
  for (std::size_t r = 0; r < kPixelRejects; ++r) out.counts[r] = count_of(out.reject, static_cast<PixelReject>(r));
  out.patch.valid_px = out.counts[static_cast<std::size_t>(PixelReject::kNone)];
}

}  // namespace enamel::pipeline
