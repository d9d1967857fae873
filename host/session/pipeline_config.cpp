#include "host/session/pipeline_config.hpp"

namespace enamel::host {

namespace {

void bind_decode(ConfigReader r, pipeline::DecodeConfig& c) {
  r.bind("dark_sigmas", c.phase.dark_sigmas, {0.0F, 100.0F}, "brightest frame must exceed black by this many sigma");
  r.bind("saturation", c.phase.saturation, {0.5F, 1.0F}, "of full scale; brighter pixels are saturated");
  r.bind("max_sigma_rad", c.phase.max_sigma_rad, {0.01F, 1.0F}, "largest predicted phase noise of a pixel");
  r.bind("correct_closure", c.correct_closure, "undo in-burst motion and the second harmonic seen in the closure");
  r.bind("correct_ripple", c.correct_ripple, "undo the self-calibrated ripple of the waveform's harmonics");
  r.bind("correct_translucency", c.translucency.correct, "undo the apparent depth of light from inside tooth and gum");
  r.bind("min_points", c.light.min_points, {100U, 1000000U}, "bursts with fewer points are rejected");
  calib::DepthRange range = c.depth_range_mm.value_or(calib::DepthRange{});
  r.bind("near_mm", range.near_mm, {0.0, 1000.0}, "depth range when the calibration states none; 0: not given");
  r.bind("far_mm", range.far_mm, {0.0, 1000.0}, "depth range when the calibration states none; 0: not given");
  if (range.near_mm > 0 && range.far_mm > range.near_mm) c.depth_range_mm = range;
}

void bind_track(ConfigReader r, pipeline::TrackerConfig& c) {
  r.bind("start_coverage", c.start_coverage, {0.0, 1.0},
         "share of the image that must be good surface to define the model");
  r.bind("max_gap_s", c.max_gap_s, {0.05, 60.0}, "longer without a placed burst: found again by features only");
  r.bind("max_speed_mm_s", c.max_speed_mm_s, {1.0, 5000.0}, "faster alignments are not believed");
  r.bind("max_turn_deg_s", c.max_turn_deg_s, {1.0, 10000.0}, "faster alignments are not believed");
  r.bind("min_overlap", c.accept.min_overlap, {0.0, 1.0}, "share of the patch that must meet the model");
  r.bind("min_consistency", c.accept.min_consistency, {0.0, 1.0}, "of what meets the model, the share that must agree");
  r.bind("max_rms_mm", c.accept.max_rms_mm, {0.001, 1.0}, "largest residual beyond the patch's own noise");
  r.bind("soft_weight", c.icp.samples.soft_weight, {0.01, 1.0},
         "of soft tissue against teeth: so many of its samples count; 1: all");
  r.bind("keyframe_spacing_mm", c.keyframes.spacing_mm, {0.1, 50.0},
         "a keyframe where every other is farther than this");
  r.bind("keyframe_spacing_deg", c.keyframes.spacing_deg, {0.1, 90.0}, "or turned by more than this");
  c.relocalise.accept = c.accept;
}

void bind_guide(ConfigReader r, pipeline::GuideConfig& c) {
  r.bind("tolerance_mm", c.tolerance_mm, {0.02, 1.0}, "a pixel this near the model's surface lies on it");
  r.bind("min_votes", c.min_votes, {1, 1000000}, "pixels of a region that must lie on the model before it decides");
  r.bind("suspect_share", c.suspect_share, {0.0, 1.0}, "more contradiction of code and model puts the burst in doubt");
}

void bind_fuse(ConfigReader r, pipeline::FuseConfig& c) {
  r.bind("voxel_mm", c.voxel_mm, {0.02, 1.0}, "edge of a voxel");
  r.bind("truncation_voxels", c.truncation_voxels, {1.5, 8.0}, "half width of the band stored around the surface");
  r.bind("max_incidence_deg", c.max_incidence_deg, {10.0, 89.0}, "steeper measurements are not fused");
  r.bind("min_observations", c.min_observations, {1, 255}, "measurements that a voxel needs to count as surface");
  r.bind("min_bursts", c.min_bursts, {1, 255}, "different bursts that they must come from");
  r.bind("carve_margin_mm", c.carve_margin_mm, {0.1, 10.0}, "unconfirmed surface seen through with this margin goes");
  r.bind("carve_bursts", c.carve_bursts, {0, 255},
         "bursts that must look through confirmed surface, for each moment that it was seen in; 0: it stays");
  r.bind("carve_confirmed_mm", c.carve_confirmed_mm, {0.2, 10.0}, "and by so much");
}

void bind_mesh(ConfigReader r, pipeline::MeshConfig& c) {
  r.bind("max_step_voxels", c.max_step_voxels, {1.8, 6.0}, "larger steps of distance inside a cell are two surfaces");
  r.bind("min_component_triangles", c.min_component_triangles, {0, 1000000}, "smaller floating pieces are left out");
  r.bind("passing_bursts", c.passing_bursts, {0, 1000000},
         "a floating piece seen in no more bursts on end passed by; 0: off");
  r.bind("passing_triangles", c.passing_triangles, {0, 1000000}, "and is left out unless it is larger");
}

void bind_map(ConfigReader r, pipeline::MapConfig& c) {
  r.bind("refine", c.refine, "after the scan: poses over all keyframes, every burst fused anew; --fast leaves it out");
  r.bind("spacing_mm", c.spacing_mm, {0.2, 20.0}, "a keyframe of the map every so far along the way");
  r.bind("spacing_deg", c.spacing_deg, {0.5, 45.0}, "or turned by more than this");
  r.bind("nodes_kept", c.nodes_kept, {16U, 1000000U}, "keyframes in memory at a time, 2.5 MB each; fewer take longer");
}

}  // namespace

void bind(ConfigReader& reader, PipelineConfig& config) {
  reader.bind("graph.feedback_delay", config.feedback_delay, {1, 8},
              "bursts between fusion and its use in registration");
  reader.bind("graph.preview_period", config.preview_period, {1, 30},
              "the preview's surface is renewed every so many bursts");
  bind_decode(reader.table("decode"), config.decode);
  bind_track(reader.table("track"), config.track);
  bind_guide(reader.table("guide"), config.guide);
  bind_fuse(reader.table("fuse"), config.fuse);
  bind_mesh(reader.table("mesh"), config.mesh);
  bind_map(reader.table("map"), config.map);
}

}  // namespace enamel::host
