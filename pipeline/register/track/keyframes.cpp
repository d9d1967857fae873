#include "pipeline/register/track/keyframes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pipeline/types/viewpoint.hpp"

namespace enamel::pipeline {
namespace {

double work_point_distance(const Pose& a, const Pose& b, double work_distance_mm) {
  const Vec3d work(0, 0, work_distance_mm);
  return (a * work - b * work).norm();
}

}  // namespace

bool KeyframeStore::wants(const Pose& T_model_cam) const {
  const Vec3d work(0, 0, config_.work_distance_mm);
  return std::none_of(frames_.begin(), frames_.end(), [&](const Keyframe& frame) {
    return look_alike(frame.T_model_cam, T_model_cam, work, {config_.spacing_mm, config_.spacing_deg});
  });
}

void KeyframeStore::add(const SurfacePatch& patch, const Pose& T_model_cam, ModelView view) {
  const double px_per_mm = lens_.fx / config_.work_distance_mm;
  Keyframe& frame = frames_.emplace_back();
  frame.T_model_cam = T_model_cam;
  frame.pictures = make_feature_pictures(patch, px_per_mm, config_.features);
  frame.view = std::move(view);
  frame.grid = make_surface_grid(patch, px_per_mm, config_.surface.grid);
}

void KeyframeStore::describe_surface(Keyframe& frame) const {
  if (frame.surface_described) return;
  frame.surface = extract_surface_features(frame.grid, config_.surface);
  frame.surface_described = true;
  frame.grid = {};
}

void KeyframeStore::describe_surface(const std::vector<std::size_t>& asked) {
  for (const std::size_t k : asked) describe_surface(frames_[k]);
}

void KeyframeStore::describe_next_surface() {
  const auto waits = std::ranges::find(frames_, false, &Keyframe::surface_described);
  if (waits != frames_.end()) describe_surface(*waits);
}

void KeyframeStore::describe(const std::vector<std::size_t>& asked, std::size_t most) {
  for (const std::size_t k : asked) {
    if (most == 0) return;
    if (frames_[k].features) continue;
    frames_[k].features = extract_features(frames_[k].pictures, config_.features);
    frames_[k].pictures = {};
    --most;
  }
}

void KeyframeStore::absorb(KeyframeStore&& other, const Pose& T_model_other) {
  for (Keyframe& frame : other.frames_) {
    const Pose T_model_cam = T_model_other * frame.T_model_cam;
    if (!wants(T_model_cam)) continue;
    frame.T_model_cam = T_model_cam;
    frame.view = carried_into(T_model_other, std::move(frame.view));
    frames_.push_back(std::move(frame));
  }
  other.frames_.clear();
}

std::vector<std::size_t> KeyframeStore::candidates(const Pose& T_model_cam, std::uint64_t turn,
                                                   std::size_t most) const {
  std::vector<std::size_t> order(frames_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<double> distance;
  distance.reserve(frames_.size());
  for (const Keyframe& frame : frames_) {
    distance.push_back(work_point_distance(frame.T_model_cam, T_model_cam, config_.work_distance_mm));
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
  });
  if (order.size() <= most) return order;
  const std::size_t near = most / 2;
  const std::size_t far = most - near;
  const std::size_t others = order.size() - near;
  std::vector<std::size_t> out(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(near));
  for (std::size_t k = 0; k < far; ++k) out.push_back(order[near + (turn * far + k) % others]);
  return out;
}

}  // namespace enamel::pipeline
