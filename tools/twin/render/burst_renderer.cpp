#include "tools/twin/render/burst_renderer.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace enamel::twin {
namespace {

constexpr int kRowsPerTask = 4;

}  // namespace

SamplePattern::SamplePattern(int grid) {
  const double n = grid;
  for (int i = 0; i < grid; ++i) {
    for (int j = 0; j < grid; ++j) {
      dx.push_back((i + (j + 0.5) / n) / n - 0.5);
      dy.push_back((j + (n - 1 - i + 0.5) / n) / n - 0.5);
      order.push_back(static_cast<std::size_t>(j * grid + (grid - 1 - i)));
    }
  }
  // The two outermost rows of samples, first and last instants, go first: see agree().
  const auto swap_with = [&](std::size_t a, std::size_t b) {
    std::swap(dx[a], dx[b]);
    std::swap(dy[a], dy[b]);
    std::swap(order[a], order[b]);
  };
  const auto [lowest, highest] = std::minmax_element(dy.begin(), dy.end());
  const auto low = static_cast<std::size_t>(lowest - dy.begin()), high = static_cast<std::size_t>(highest - dy.begin());
  swap_with(0, low);
  if (dy.size() > 1) swap_with(1, high == 0 ? low : high);
}

BurstRenderer::BurstRenderer(const Instrument& instrument, const RayScene& scene, const RenderConfig& config)
    : instrument_(instrument),
      tracer_(instrument, scene, config.light),
      config_(config),
      pattern_(config.grid),
      width_(instrument.rig.camera.width),
      height_(instrument.rig.camera.height) {
  directions_ = ray_table(instrument.camera, width_, height_, pattern_.dx, pattern_.dy);
  centres_ = ray_table(instrument.camera, width_, height_, {0.0}, {0.0});
}

void BurstRenderer::add_light(const Lanes8& lights, std::size_t x0, const Frames& frames, RowSums& sums) const {
  const std::size_t n = std::min(kPacket, sums[0].size() - x0);
  for (std::size_t i = 0; i < n; ++i) {
    const Lane& lane = lights[i];
    if (!lane.hit) continue;
    const bool shines = lane.weight > 0;
    const auto tap = shines ? instrument_.light.tap(axis_coordinate(lane), lane.sigma2) : ProjectorLight::Tap{};
    for (std::size_t k = frames.first; k < frames.end; ++k) {
      const float e = shines ? instrument_.light.emission(static_cast<int>(k), tap) : 0.0F;
      sums[k][x0 + i] += lane.weight * static_cast<double>(e) + lane.ambient;
      if (lane.lamp > 0) sums[k][x0 + i] += lane.lamp * frames.lamp[k];
    }
    for (std::size_t part = 0; part < lane.parts; ++part) {
      const LightPart& from = lane.part[part];
      for (std::size_t k = frames.first; k < frames.end; ++k) {
        const float e =
            instrument_.light.blurred(static_cast<int>(k), from.coordinate, static_cast<double>(from.sigma2));
        sums[k][x0 + i] += static_cast<double>(from.weight * e);
      }
    }
  }
}

/// Shade that the outer two samples of the pixel and of both its neighbours agree on: the samples between them, in
/// space and in time, then need no shadow ray of their own. A shadow missed so would be narrower than 0.02 mm.
void BurstRenderer::agree(const std::array<std::vector<Shade>, 2>& outer, std::vector<Shade>& known) {
  const std::size_t w = known.size();
  for (std::size_t x = 0; x < w; ++x) {
    Shade common = outer[0][x];
    for (std::size_t n = x == 0 ? 0 : x - 1; n <= std::min(x + 1, w - 1); ++n) {
      if (outer[0][n] != common || outer[1][n] != common) common = Shade::kUnknown;
    }
    known[x] = common;
  }
}

/// views: one an instant, of four frames or, where nothing moves, of one for all.
void BurstRenderer::render_row(const std::vector<View>& views, const std::array<double, 4>& lamp, int y,
                               RowSums& sums) const {
  const std::size_t samples = pattern_.dx.size(), w = static_cast<std::size_t>(width_);
  for (auto& s : sums) s.assign(w, 0.0);
  const bool is_static = views.size() == samples;
  std::array<std::vector<Shade>, 2> outer{std::vector<Shade>(w), std::vector<Shade>(w)};
  std::vector<Shade> known(w, Shade::kUnknown);
  Lanes8 lights;
  for (std::size_t frame = 0; frame < (is_static ? 1 : 4); ++frame) {
    for (std::size_t s = 0; s < samples; ++s) {
      const std::size_t instant = y % 2 == 0 ? pattern_.order[s] : samples - 1 - pattern_.order[s];
      const View& view = is_static ? views.front() : views[frame * samples + instant];
      const double* d = directions_.data() + (static_cast<std::size_t>(y) * samples + s) * w * 2;
      if (s == 2) agree(outer, known);
      const bool reuse = s >= 2 && !config_.every_shadow_ray;
      for (int x0 = 0; x0 < width_; x0 += static_cast<int>(kPacket)) {
        const auto at = static_cast<std::size_t>(x0);
        tracer_.trace(view, d + 2 * at, std::min(kPacket, w - at), reuse ? known.data() + at : nullptr, lights);
        add_light(lights, at, {frame, is_static ? 4 : frame + 1, lamp}, sums);
        for (std::size_t i = 0; s < 2 && i < std::min(kPacket, w - at); ++i) {
          const Lane& lane = lights[i];
          outer[s][at + i] = !lane.faces ? Shade::kUnknown : (lane.lit ? Shade::kLit : Shade::kDark);
        }
      }
    }
  }
}

std::array<std::vector<float>, 4> BurstRenderer::render(const BurstPoses& poses, const Passing& passing) const {
  const std::size_t samples = pattern_.dx.size(), w = static_cast<std::size_t>(width_);
  std::vector<View> views;
  const bool is_static = poses.is_static && passing.guests.mid.empty();
  for (std::size_t k = 0; k < (is_static ? 1 : 4); ++k) {
    for (std::size_t i = 0; i < samples; ++i) {
      views.emplace_back(instrument_, is_static ? poses.mid : poses.frames[k][i]);
      if (!passing.guests.mid.empty()) views.back().guests = passing.guests.frames[k][i];
    }
  }
  std::array<std::vector<float>, 4> out;
  for (auto& image : out) image.resize(w * static_cast<std::size_t>(height_));
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRowsPerTask), [&](const auto& range) {
    RowSums sums;
    for (int y = range.begin(); y < range.end(); ++y) {
      render_row(views, passing.lamp, y, sums);
      for (std::size_t k = 0; k < 4; ++k) {
        float* row = out[k].data() + static_cast<std::size_t>(y) * w;
        for (std::size_t x = 0; x < w; ++x) row[x] = static_cast<float>(sums[k][x] / static_cast<double>(samples));
      }
    }
  });
  return out;
}

void BurstRenderer::truth_row(const View& view, int y, TruthMaps& maps) const {
  constexpr double kNoOrder = 255;
  const std::size_t w = static_cast<std::size_t>(width_);
  const double* d = centres_.data() + static_cast<std::size_t>(y) * w * 2;
  Lanes8 lights;
  for (int x0 = 0; x0 < width_; x0 += static_cast<int>(kPacket)) {
    const std::size_t n = std::min(kPacket, w - static_cast<std::size_t>(x0));
    tracer_.trace(view, d + 2 * static_cast<std::size_t>(x0), n, nullptr, lights);
    for (std::size_t i = 0; i < n; ++i) {
      const Lane& lane = lights[i];
      const std::size_t at = static_cast<std::size_t>(y) * w + static_cast<std::size_t>(x0) + i;
      maps.depth[at] = lane.hit ? static_cast<float>(lane.z) : std::numeric_limits<float>::quiet_NaN();
      maps.lit[at] = lane.lit ? 255 : 0;
      maps.mover[at] = lane.guest;
      const double order = std::floor(axis_coordinate(lane) / instrument_.rig.patterns.period_px);
      maps.order[at] = static_cast<std::uint8_t>(lane.in_projector ? std::clamp(order, 0.0, kNoOrder) : kNoOrder);
    }
  }
}

TruthMaps BurstRenderer::truth(const Pose& T_model_cam, const Guests& guests) const {
  View view(instrument_, T_model_cam);
  view.guests = guests;
  TruthMaps maps;
  const std::size_t n = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  maps.depth.resize(n);
  maps.lit.resize(n);
  maps.order.resize(n);
  maps.mover.resize(n);
  tbb::parallel_for(tbb::blocked_range<int>(0, height_, kRowsPerTask), [&](const auto& range) {
    for (int y = range.begin(); y < range.end(); ++y) truth_row(view, y, maps);
  });
  return maps;
}

}  // namespace enamel::twin
