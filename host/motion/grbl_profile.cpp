#include "host/motion/grbl_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "protocol/base/config.hpp"

namespace enamel::motion {
namespace {

constexpr double kMostDeg = 100'000.0;  // of travel: some hundred turns

void bind_axis(ConfigReader& r, const std::string& table, GrblAxisConfig& axis) {
  const auto key = [&](const char* name) { return table + "." + name; };
  r.bind(key("letter"), axis.letter, "X, Y or Z of the controller");
  r.bind(key("deg_per_unit"), axis.deg_per_unit, {-1000.0, 1000.0}, "degrees a unit; negative: turns the other way");
  r.bind(key("steps_per_deg"), axis.steps_per_deg, {0.1, 100'000.0},
         "motor steps a degree, microsteps and gear included");
  r.bind(key("min_deg"), axis.min_deg, {-kMostDeg, kMostDeg}, "travel begins");
  r.bind(key("max_deg"), axis.max_deg, {-kMostDeg, kMostDeg}, "travel ends");
  r.bind(key("home_deg"), axis.home_deg, {-kMostDeg, kMostDeg}, "angle after homing");
  if (axis.letter != "X" && axis.letter != "Y" && axis.letter != "Z") r.reject(key("letter"), "X, Y or Z");
  if (std::abs(axis.deg_per_unit) < 1e-3) r.reject(key("deg_per_unit"), "at least 0.001 or at most -0.001");
  if (axis.min_deg >= axis.max_deg) r.reject(key("max_deg"), "must be above min_deg");
  if (axis.home_deg < axis.min_deg || axis.home_deg > axis.max_deg) {
    r.reject(key("home_deg"), "must lie between min_deg and max_deg");
  }
}

Result<GrblProfile> bind_profile(ConfigReader reader) {
  GrblProfile p;
  bind_axis(reader, "rotation", p.rot);
  bind_axis(reader, "swing", p.swing);
  reader.bind("motion.feed_deg_per_s", p.feed_deg_per_s, {0.01, 1000.0}, "speed of the axis that goes further");
  reader.bind("motion.overshoot_deg", p.overshoot_deg, {0.0, 10.0}, "how far below a target it is approached");
  reader.bind("motion.settle_ms", p.settle_ms, {0.0, 10'000.0}, "rest before the first exposure");
  reader.bind("controller.banner_ms", p.banner_ms, {100.0, 10'000.0}, "time a controller takes to start");
  if (p.rot.letter == p.swing.letter) reader.reject("swing.letter", "this letter is the rotation's already");
  for (const auto& [table, axis] : {std::pair{"rotation", &p.rot}, std::pair{"swing", &p.swing}}) {
    if (axis->max_deg - axis->min_deg <= p.overshoot_deg) {
      reader.reject("motion.overshoot_deg", fmt::format("leaves no room within the travel of [{}]", table));
    }
  }
  ENAMEL_TRY(reader.finish());
  return p;
}

class Findings {
 public:
  explicit Findings(const GrblSettings& settings) : settings_(settings) {}
  void expect(int number, double want, const char* why) {
    const auto it = settings_.find(number);
    if (it == settings_.end()) {
      texts_.push_back(fmt::format("${} is not reported ({})", number, why));
    } else if (std::abs(it->second - want) > 1e-3 * std::max(1.0, std::abs(want))) {
      texts_.push_back(fmt::format("${} is {:g}, expected {:g} ({}); send ${}={:g} or correct the profile", number,
                                   it->second, want, why, number, want));
    }
  }
  void expect_bit(int number, unsigned bit, const char* why) {
    const auto it = settings_.find(number);
    const bool is_set = it != settings_.end() && ((static_cast<unsigned>(std::lround(it->second)) >> bit) & 1U) != 0;
    if (!is_set) texts_.push_back(fmt::format("${} lacks the bit {} ({})", number, 1U << bit, why));
  }
  [[nodiscard]] Result<void> result() const {
    if (texts_.empty()) return {};
    return fail(ErrorCode::kConfigValue,
                fmt::format("the controller is set up for another table: {}", fmt::join(texts_, "; ")));
  }

 private:
  const GrblSettings& settings_;
  std::vector<std::string> texts_;
};

}  // namespace

std::size_t letter_index(const GrblAxisConfig& axis) { return static_cast<std::size_t>(axis.letter.front() - 'X'); }

Result<GrblProfile> read_grbl_profile(const std::filesystem::path& path) {
  ENAMEL_TRY_ASSIGN(ConfigReader reader, ConfigReader::from_file(path));
  return bind_profile(std::move(reader));
}

Result<GrblProfile> parse_grbl_profile(std::string_view text, std::string_view name) {
  ENAMEL_TRY_ASSIGN(ConfigReader reader, ConfigReader::from_text(text, name));
  return bind_profile(std::move(reader));
}

Result<void> check_settings(const GrblSettings& settings, const GrblProfile& profile) {
  Findings findings(settings);
  for (const GrblAxisConfig* axis : {&profile.rot, &profile.swing}) {
    // Wrong microsteps (3200 against 6400 steps a turn) would double every angle and pass unnoticed.
    findings.expect(100 + static_cast<int>(letter_index(*axis)), axis->steps_per_deg * std::abs(axis->deg_per_unit),
                    "steps a unit");
  }
  findings.expect(1, 255.0, "motors without current between moves jump to a full step");
  findings.expect(13, 0.0, "reports in inches falsify positions");
  findings.expect(20, 1.0, "soft limits stop a target that noise changed");
  findings.expect(22, 1.0, "without homing no angle is known");
  findings.expect(32, 0.0, "laser mode does not stop between moves");
  findings.expect_bit(10, 0, "reports must carry the machine position; send $10=1");
  return findings.result();
}

AxesAngles GrblScale::angles(const std::array<double, 2>& units) const {
  return {home_deg[0] + (units[0] - home_units[0]) * deg_per_unit[0],
          home_deg[1] + (units[1] - home_units[1]) * deg_per_unit[1]};
}

std::array<double, 2> GrblScale::units(const AxesAngles& angles) const {
  return {home_units[0] + (angles.rot_deg - home_deg[0]) / deg_per_unit[0],
          home_units[1] + (angles.swing_deg - home_deg[1]) / deg_per_unit[1]};
}

Result<void> check_travel(const GrblSettings& settings, const GrblProfile& profile, const GrblScale& scale) {
  constexpr double kRounding = 1e-3;  // the controller prints three decimals
  const AxesLimits travel = profile.travel();
  const auto ends_a = scale.units({travel.rot.min_deg, travel.swing.min_deg});
  const auto ends_b = scale.units({travel.rot.max_deg, travel.swing.max_deg});
  const std::array<const GrblAxisConfig*, 2> axes{&profile.rot, &profile.swing};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const int number = 130 + static_cast<int>(letter_index(*axes[i]));
    const auto it = settings.find(number);
    const double reach = it == settings.end() ? 0.0 : it->second;
    const auto [low, high] = std::minmax(ends_a[i], ends_b[i]);
    if (low >= -reach - kRounding && high <= kRounding) continue;
    return fail(
        ErrorCode::kConfigValue,
        fmt::format("{} {}..{} deg is {:.3f}..{:.3f} of axis {}, the controller allows {:.3f}..0: raise ${}, or "
                    "correct home_deg, min_deg, max_deg and the homing direction $23",
                    i == 0 ? "rotation" : "swing", axes[i]->min_deg, axes[i]->max_deg, low, high, axes[i]->letter,
                    -reach, number));
  }
  return {};
}

double feed_units_per_min(const AxesAngles& from, const AxesAngles& to, const GrblProfile& profile) {
  const double rot = to.rot_deg - from.rot_deg;
  const double swing = to.swing_deg - from.swing_deg;
  const double seconds = std::max(std::abs(rot), std::abs(swing)) / profile.feed_deg_per_s;
  if (seconds <= 0.0) return 1.0;
  // GRBL's feed is along the line through both axes, whatever their units mean.
  const double units = std::hypot(rot / profile.rot.deg_per_unit, swing / profile.swing.deg_per_unit);
  return std::max(1.0, units / seconds * 60.0);
}

}  // namespace enamel::motion
