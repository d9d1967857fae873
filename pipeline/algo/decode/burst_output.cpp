#include "pipeline/algo/decode/burst_output.hpp"

#include <algorithm>
#include <limits>

#include "pipeline/algo/phase/poly_trig.hpp"

namespace enamel::algo {
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
    *m = Map<float>(w, h);
  out.order = Map<std::uint8_t>(w, h);
  out.reject = Map<PixelReject>(w, h);
  out.patch.points = out.patch.normals = Map<Vec3f>(w, h, Vec3f::Constant(kNan));
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

void count_rejects(DecodedBurst& out) {
  constexpr std::size_t kApart = 4;  // neighbours, mostly equal, count in different places and need not wait
  std::array<std::array<std::size_t, kPixelRejects>, kApart> counts{};
  const auto pixels = out.reject.pixels();
  for (std::size_t i = 0; i < pixels.size(); ++i) ++counts[i % kApart][static_cast<std::size_t>(pixels[i])];
  for (std::size_t r = 0; r < kPixelRejects; ++r)
    out.counts[r] = counts[0][r] + counts[1][r] + counts[2][r] + counts[3][r];
  out.patch.valid_px = out.counts[static_cast<std::size_t>(PixelReject::kNone)];
}

}  // namespace enamel::algo
