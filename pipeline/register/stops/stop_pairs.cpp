#include "pipeline/register/stops/stop_pairs.hpp"

#include <algorithm>
#include <cmath>

namespace enamel::pipeline {
namespace {

constexpr std::size_t kAsked = 600;  // samples: a share of 20 % is known to 1.6 %

}  // namespace

double overlap_of(const MapNode& i, const MapNode& j, const ViewCamera& camera, const Pose& T_j_i, double gate_mm) {
  const SampleSet& samples = i.samples;
  const Reference& reference = j.reference;
  if (samples.size() == 0 || reference.empty()) return 0;
  const Eigen::Matrix3f R = T_j_i.linear().cast<float>();
  const Vec3f t = T_j_i.translation().cast<float>();
  const auto gate = static_cast<float>(gate_mm);
  const std::size_t step = std::max<std::size_t>(1, samples.size() / kAsked);
  std::size_t asked = 0, seen = 0;
  for (std::size_t n = 0; n < samples.size(); n += step) {
    ++asked;
    const Vec3f p = R * Vec3f(samples.x[n], samples.y[n], samples.z[n]) + t;
    if (!(p.z() > 0)) continue;
    const Vec2f at = camera.project(p) * reference.pixels_per_camera_pixel();
    const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
    if (u < 0 || v < 0 || u >= reference.width() || v >= reference.height()) continue;
    const Reference::Pixel& q = reference.pixel(
        static_cast<std::size_t>(v) * static_cast<std::size_t>(reference.width()) + static_cast<std::size_t>(u));
    if (std::isnan(q.point.x())) continue;
    const Vec3f normal = R * Vec3f(samples.nx[n], samples.ny[n], samples.nz[n]);
    if (normal.dot(q.normal) < 0.7F || std::abs(q.normal.dot(p - q.point)) > gate) continue;
    ++seen;
  }
  return static_cast<double>(seen) / static_cast<double>(asked);
}

std::vector<StopPair> overlapping_pairs(const std::vector<Stop>& stops, const std::vector<Pose>& T_model_cam,
                                        const ViewCamera& camera, double gate_mm, double min_overlap) {
  std::vector<StopPair> out;
  for (std::size_t i = 1; i < stops.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Pose T_j_i = T_model_cam[j].inverse() * T_model_cam[i];
      const double one = overlap_of(stops[i].node, stops[j].node, camera, T_j_i, gate_mm);
      if (one < min_overlap) continue;
      const double other = overlap_of(stops[j].node, stops[i].node, camera, T_j_i.inverse(), gate_mm);
      if (other >= min_overlap) out.push_back({i, j, std::min(one, other)});
    }
  }
  return out;
}

}  // namespace enamel::pipeline
