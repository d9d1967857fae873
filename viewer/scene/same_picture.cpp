#include "viewer/scene/same_picture.hpp"

#include <cmath>
#include <tuple>

namespace enamel::view {
namespace {

bool alike(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool alike(const Pose& a, const Pose& b) { return (a.matrix().array() == b.matrix().array()).all(); }

auto words(const PreviewFrame& f) { return std::tie(f.state, f.result, f.message, f.simulated, f.rejected, f.track); }

auto objects(const PreviewFrame& f) { return std::tie(f.live, f.model, f.whole, f.pipeline); }

auto counts(const PreviewCounters& c) {
  return std::tie(c.captured, c.fused, c.rejected, c.shed, c.incomplete, c.lost_on_wire, c.accepted);
}

bool same_sight(const Sight& a, const Sight& b) {
  return a.trouble == b.trouble && a.x_px == b.x_px && a.y_px == b.y_px;
}

}  // namespace

bool same_picture(const PreviewFrame& a, const PreviewFrame& b) {
  return a.burst == b.burst && a.placed == b.placed && a.segment == b.segment && a.undetermined == b.undetermined &&
         words(a) == words(b) && objects(a) == objects(b) && counts(a.counters) == counts(b.counters) &&
         a.trail.size() == b.trail.size() && same_sight(a.sight, b.sight) && alike(a.track_overlap, b.track_overlap) &&
         alike(a.surface_distance_mm, b.surface_distance_mm) && alike(a.rate_hz, b.rate_hz) &&
         alike(a.latency_ms, b.latency_ms) && alike(a.refined, b.refined) && alike(a.T_model_cam, b.T_model_cam) &&
         alike(a.T_model_return, b.T_model_return);
}

}  // namespace enamel::view
