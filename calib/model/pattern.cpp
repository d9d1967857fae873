#include "calib/model/pattern.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace enamel::calib {
namespace {

/// To a millionth of a level. Where a wave crosses its mean it lies half way between two levels, and what cos and sin
/// leave of zero (1e-14) would round it up in one fringe and down in the next: 0.8 mrad of the fringe's phase each.
double without_rounding_noise(double level) {
  constexpr double kSteps = 1 << 20;
  return std::nearbyint(level * kSteps) / kSteps;
}

double wave(const PatternValues& p, double phase) { return p.mean + p.amplitude * std::cos(phase); }

/// The half fringe of phase phi >= 0. A pixel on a border of two cells to rounding belongs to the one that begins
/// there; the pattern is at its mean either way.
long cell_of(double phi) { return std::lround(std::floor(phi / std::numbers::pi + 1e-9)); }

}  // namespace

std::string_view name_of(PatternMode mode) noexcept {
  switch (mode) {
    case PatternMode::kPlain4:
      return "plain4";
    case PatternMode::kPolarity:
      return "T";
    case PatternMode::kSingle:
      return "single";
    case PatternMode::kMicro:
      return "M";
    case PatternMode::kMulti:
      break;
  }
  return "multi";
}

bool is_burst_set(const PatternValues& patterns) noexcept { return patterns.mode != PatternMode::kMulti; }

int polarity_of_cell(const PatternValues& p, long cell) noexcept {
  if (p.mode == PatternMode::kSingle) return cell >= 0 && cell / 2 == p.marker_fringe ? -1 : 1;
  if (p.mode != PatternMode::kPolarity || p.polarity_code.empty()) return 1;
  const auto length = static_cast<long>(p.polarity_code.size());
  return p.polarity_code[static_cast<std::size_t>(((cell + p.first_cell) % length + length) % length)];
}

double pattern_level(const PatternValues& p, int frame, int i) {
  const double phi = 2 * std::numbers::pi * i / p.period_px;
  const auto level = [&] {
    if (p.mode == PatternMode::kMicro) {
      if (frame == 1) return wave(p, phi * (1 + 1 / p.code_ratio));
      const int j = frame == 0 ? 0 : frame - 1;
      return wave(p, phi + 2 * std::numbers::pi * j / 3);
    }
    if (frame == 3) return p.mean + polarity_of_cell(p, cell_of(phi)) * p.amplitude * std::sin(phi);
    return wave(p, phi + frame * std::numbers::pi / 2);
  };
  return without_rounding_noise(level());
}

PatternLevels pattern_levels(const Rig& rig) {
  PatternLevels levels{.axis_v = rig.patterns.axis_v, .frames = {}};
  const int n = levels.axis_v ? rig.projector.height : rig.projector.width;
  for (int frame = 0; frame < 4; ++frame) {
    for (int i = 0; i < n; ++i) {
      const double wanted = pattern_level(rig.patterns, frame, i);
      levels.frames[static_cast<std::size_t>(frame)].push_back(
          rig.response ? without_rounding_noise(level_for(*rig.response, wanted)) : wanted);
    }
  }
  return levels;
}

PatternTable pattern_table(const Rig& rig) {
  const PatternLevels levels = pattern_levels(rig);
  PatternTable table{.axis_v = levels.axis_v, .frames = {}};
  for (std::size_t frame = 0; frame < levels.frames.size(); ++frame) {
    for (const double level : levels.frames[frame])
      table.frames[frame].push_back(static_cast<std::uint8_t>(std::lround(std::clamp(level, 0.0, 255.0))));
  }
  return table;
}

}  // namespace enamel::calib
