#include "tools/twin/scene/path_keys.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace enamel::twin {
namespace {

using Names = std::string_view;
constexpr std::array<std::pair<Names, PathKind>, 4> kPaths{{{"views", PathKind::kViews},
                                                            {"arch", PathKind::kArch},
                                                            {"calibration", PathKind::kCalibration},
                                                            {"mount", PathKind::kMount}}};
constexpr std::array<std::pair<Names, Joint>, 2> kJoints{{{"turn", Joint::kTurn}, {"pause", Joint::kPause}}};

void bind_view(ConfigReader r, ViewConfig& v) {
  r.bind("distance_mm", v.distance_mm, {1, 1000}, "camera to target");
  r.bind("tilt_x_deg", v.tilt_x_deg, {-89, 89}, "about the camera's x axis, through the target");
  r.bind("tilt_y_deg", v.tilt_y_deg, {-89, 89}, "about the camera's y axis");
  r.bind("roll_deg", v.roll_deg, {-360, 360}, "about the optical axis");
  r.bind("target_mm", v.target_mm, {-1000, 1000}, "model point on the optical axis");
  r.bind("velocity_mm_s", v.velocity_mm_s, {-1000, 1000}, "camera frame");
  r.bind("turn_deg_s", v.turn_deg_s, {-1000, 1000}, "rotation about the target, camera frame");
  r.bind("bursts", v.bursts, {1, 100000}, "bursts from this stand");
}

void bind_pass(ConfigReader r, PassConfig& p) {
  r.bind("from_mm", p.from_mm, {-70, 70}, "arc length at the beginning");
  r.bind("to_mm", p.to_mm, {-70, 70}, "arc length at the end");
  r.bind("roll_deg", p.roll_deg, {-80, 80}, "about the arch; positive: from the cheek side");
  r.bind("height_mm", p.height_mm, {-20, 20}, "height of the point looked at, above the gum margin");
  r.bind("offset_mm", p.offset_mm, {-25, 15}, "of that point from the arch, outwards");
  r.bind("spin_deg", p.spin_deg, {-180, 180},
         "about the viewing axis: a sweep turned by 60 and more shows the rig's bow");
  r.bind("after", p.after, kJoints, "how the hand comes from the pass before: in a turn, or while the probe is paused");
  r.bind("pause_s", p.pause_s, {0.05, 60}, "length of that pause");
}

void bind_gap(ConfigReader r, GapConfig& g) {
  r.bind("pass", g.pass, {0, 1000}, "in which pass, counted from 0");
  r.bind("at_mm", g.at_mm, {-70, 70}, "arc length at which the probe is paused; the hand goes on");
  r.bind("bursts", g.bursts, {1, 10000}, "bursts left out");
}

void bind_hand(ConfigReader& r, SceneConfig& c) {
  r.bind("speed_mm_s", c.arch_path.speed_mm_s, {0.1, 200}, "arch: speed of the point looked at");
  r.bind("surge_mm_s", c.arch_path.surge_mm_s, {0, 200}, "arch: the speed swings by so much about speed_mm_s");
  r.bind("surge_s", c.arch_path.surge_s, {0.1, 10}, "arch: length of a swing, about: whole swings a pass");
  r.bind("turn_s", c.arch_path.turn_s, {0.05, 10}, "arch: from one pass to the next");
  r.bind("distance_mm", c.arch_path.distance_mm, {1, 1000}, "arch: camera to the point looked at");
  r.bind("from_s", c.arch_path.from_s, {0, 3600}, "arch: bursts from then on; the hand begins at 0");
  r.bind("tremor_um", c.tremor.tremor_um, {0, 2000}, "8 to 12 Hz, peak an axis");
  r.bind("tremor_deg", c.tremor.tremor_deg, {0, 10}, "8 to 12 Hz, peak an axis");
  r.bind("wander_mm", c.tremor.wander_mm, {0, 20}, "0.2 to 1 Hz, peak an axis");
  r.bind("wander_deg", c.tremor.wander_deg, {0, 45}, "0.2 to 1 Hz, peak an axis");
  r.bind("pivot_mm", c.tremor.pivot_mm, {0, 200}, "the hand turns about this point before the camera");
}

template <class T>
void bind_all(ConfigReader& r, std::string_view key, std::vector<T>& values, void (*bind)(ConfigReader, T&)) {
  values.resize(r.table_count(key));
  for (std::size_t i = 0; i < values.size(); ++i) bind(r.table(key, i), values[i]);
}

void check_gap(ConfigReader r, const GapConfig& g, const std::vector<PassConfig>& passes) {
  const auto i = static_cast<std::size_t>(g.pass);
  if (i >= passes.size()) {
    r.reject("pass",
             "is " + std::to_string(g.pass) + ", but passes count from 0 to " + std::to_string(passes.size() - 1));
    return;
  }
  const auto [low, high] = std::minmax(passes[i].from_mm, passes[i].to_mm);
  if (g.at_mm < low || g.at_mm > high) r.reject("at_mm", "lies outside from_mm to to_mm of that pass");
}

void check_arch(ConfigReader r, const SceneConfig& c) {
  const std::vector<PassConfig>& passes = c.arch_path.passes;
  if (c.arch_path.surge_mm_s > c.arch_path.speed_mm_s)
    r.reject("surge_mm_s", "exceeds speed_mm_s: the hand would go back");
  if (c.object != ObjectKind::kJaw && c.object != ObjectKind::kRidge) {
    r.reject("type", "an arch path needs a jaw or a ridge");
  }
  if (passes.empty()) {
    r.reject("type", "no [[path.pass]] given");
    return;
  }
  if (passes.front().after == Joint::kPause) r.table("pass", 0).reject("after", "no pass comes before the first");
  for (std::size_t i = 0; i < c.arch_path.gaps.size(); ++i) check_gap(r.table("gap", i), c.arch_path.gaps[i], passes);
}

}  // namespace

void bind_path(ConfigReader& reader, SceneConfig& c) {
  ConfigReader r = reader.table("path");
  r.bind("type", c.path, kPaths,
         "views (stands and straight flights), arch (along a jaw or ridge), calibration (a board, by seed) or mount");
  bind_hand(r, c);
  bind_all(r, "view", c.views, bind_view);
  bind_all(r, "pass", c.arch_path.passes, bind_pass);
  bind_all(r, "gap", c.arch_path.gaps, bind_gap);
  if (c.path == PathKind::kArch) check_arch(r, c);
  if (c.path == PathKind::kViews && c.views.empty()) r.reject("type", "no [[path.view]] given");
}

}  // namespace enamel::twin
