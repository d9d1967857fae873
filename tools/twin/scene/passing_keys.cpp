#include "tools/twin/scene/passing_keys.hpp"

namespace enamel::twin {
namespace {

void bind_mover(ConfigReader r, MoverConfig& m) {
  r.bind("kind", m.kind, kMoverKinds, "tongue, cheek, finger or cotton");
  r.bind("share", m.share, {0, 1}, "part of the scan's time that it is there");
  r.bind("visit_s", m.visit_s, {0.1, 600}, "length of a visit, about");
  r.bind("speed_mm_s", m.speed_mm_s, {0, 200}, "peak speed of its wobbling");
  r.bind("depth_mm", m.depth_mm, {-20, 20}, "height of its top above the surface looked at, towards the probe");
  r.bind("reach_mm", m.reach_mm, {-20, 20}, "how far it comes in over the middle of the view");
  r.bind("follow", m.follow, {0, 1}, "part of the probe's way that it goes along with");
  r.bind("albedo", m.albedo, {0, 1}, "reflectance; 0: its kind's own");
  r.bind("seed", m.seed, {0, INT64_MAX}, "added to the scene's");
}

}  // namespace

void bind_passing(ConfigReader& reader, SceneConfig& c) {
  c.movers.resize(reader.table_count("mover"));
  for (std::size_t i = 0; i < c.movers.size(); ++i) bind_mover(reader.table("mover", i), c.movers[i]);
  ConfigReader f = reader.table("fog");
  f.bind("amount", c.fog.amount, {0, 1}, "part of the light scattered where the fog is thickest; 0: none");
  f.bind("veil", c.fog.veil, {0, 1}, "part of the scattered light that comes back, evenly over the image");
  f.bind("blur_px", c.fog.blur_px, {0, 50}, "Gaussian blur at amount 1, camera px");
  f.bind("change_s", c.fog.change_s, {0, 3600}, "how long it takes to come or to go, about; 0: it stays");
  ConfigReader l = reader.table("lamp");
  LampConfig& lamp = c.render.light.lamp;
  l.bind("strength", lamp.strength, {0, 10}, "full-well fraction on albedo 1 facing the lamp; 0: off");
  l.bind("direction", lamp.direction, {-1000, 1000}, "towards the lamp, model coordinates, any length");
  l.bind("flicker", lamp.flicker, {0, 1}, "relative swing of its light");
  l.bind("flicker_hz", lamp.flicker_hz, {1, 100000}, "twice the mains");
  const auto& d = lamp.direction;
  if (d[0] == 0 && d[1] == 0 && d[2] == 0) l.reject("direction", "is no direction");
}

}  // namespace enamel::twin
