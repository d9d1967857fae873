#include "host/desktop/desktop_config.hpp"

namespace enamel::host {
namespace {

void bind_exposures(ConfigReader r, ExposureConfig& c) {
  r.bind("exposures", c.exposures, {0, 3},
         "at a stop: 1 the probe's own, 2 a shorter one too, 3 a longer one too; 0: as the light needs");
  r.bind("ratio", c.ratio, {1.5, 16.0}, "of one exposure to the next");
  r.bind("min_glare", c.min_glare, {0.0, 1.0}, "share of lit pixels that clip, from which on a shorter one is needed");
  r.bind("min_dim", c.min_dim, {0.0, 1.0}, "share of lit pixels with faint fringes, from which on a longer one is");
  r.bind("seen_levels", c.seen_levels, {1, 255}, "of 255: a pixel is lit whose four frames spread by more");
  r.bind("sound_levels", c.sound_levels, {1, 255}, "and its fringes are faint while they spread by less");
}

void bind_mean(ConfigReader r, pipeline::MeanConfig& c) {
  r.bind("gate_sigmas", c.gate_sigmas, {1.0, 100.0}, "bursts farther from their middle do not count for a pixel");
  r.bind("min_agreeing", c.min_agreeing, {1, 64}, "bursts that must tell the same of a pixel, where there are so many");
}

void bind_lay(ConfigReader r, pipeline::LayConfig& c) {
  r.bind("min_overlap", c.min_overlap, {0.01, 1.0}, "of common surface, for two stops to be laid on each other");
  r.bind("overlap_gate_mm", c.overlap_gate_mm, {0.01, 10.0}, "surfaces nearer than this are foretold as common");
  r.bind("rounds", c.rounds, {1, 20}, "of poses and axes by turns; 1: the axes stay as calibrated");
  r.bind("sample_stride_px", c.sample_stride_px, {1, 16}, "of a stop's picture that is laid");
  r.bind("angle_rad", c.stop.angle_rad, {1e-6, 0.1}, "sigma of either axis at a stop");
  r.bind("shift_mm", c.stop.shift_mm, {1e-5, 1.0}, "sigma of the table's run-out");
  r.bind("turn_rad", c.stop.turn_rad, {1e-7, 0.1}, "sigma of its tilt");
  r.bind("lines_rad", c.lines.direction_rad, {1e-7, 0.1}, "what calibration leaves open of the axes' directions");
  r.bind("lines_mm", c.lines.place_mm, {1e-5, 1.0}, "and of their places");
  c.slip.stop = c.stop;
}

void bind_relief(ConfigReader r, pipeline::ReliefConfig& c) {
  r.bind("reach_mm", c.reach_mm, {1.0, 500.0}, "of the empty table, from the rotation axis");
  r.bind("cell_mm", c.cell_mm, {0.1, 10.0}, "of its heights");
  r.bind("margin_mm", c.margin_mm, {0.0, 10.0}, "above it, everything is taken out");
}

void bind_planner(ConfigReader r, pipeline::PlannerConfig& c) {
  r.bind("rot_step_deg", c.rot_step_deg, {1.0, 90.0}, "of the rotations to choose from");
  r.bind("swing_step_deg", c.swing_step_deg, {1.0, 90.0}, "of the swings");
  r.bind("max_incidence_deg", c.max_incidence_deg, {10.0, 89.0}, "steeper surface does not count as seen");
  r.bind("good_incidence_deg", c.good_incidence_deg, {10.0, 89.0}, "better than this is not looked for");
  r.bind("min_overlap", c.min_overlap, {0.0, 1.0}, "of a usual picture, with what was seen before");
  r.bind("min_gain", c.min_gain, {0.0, 1.0}, "of a usual picture: a stop that promises less is not taken");
  r.bind("max_stops", c.max_stops, {1U, 10000U}, "the scan ends there");
  r.bind("stop_s", c.stop_s, {0.0, 600.0}, "that a stop takes");
  r.bind("speed_deg_per_s", c.speed_deg_per_s, {0.1, 1000.0}, "of the table, to weigh a stop's gain by its way");
}

}  // namespace

void bind_desktop(ConfigReader& reader, DesktopConfig& config) {
  bind_exposures(reader.table("desktop.exposure"), config.exposures);
  bind_mean(reader.table("desktop.mean"), config.mean);
  bind_lay(reader.table("desktop.lay"), config.lay);
  bind_relief(reader.table("desktop.relief"), config.relief);
  bind_planner(reader.table("desktop.planner"), config.planner);
}

}  // namespace enamel::host
