#include "host/app/screen.hpp"

#include <utility>

#include "viewer/gl/offscreen.hpp"
#include "viewer/gl/picture.hpp"
#include "viewer/scene/trail.hpp"

namespace enamel::app {

namespace {

// The finished mesh in the form that the viewer takes: one block.
std::shared_ptr<const ModelSnapshot> snapshot_of(const Mesh& mesh) {
  auto block = std::make_shared<BlockMesh>();
  block->epoch = 1;
  block->vertices = mesh.vertices;
  block->normals = mesh.normals;
  block->quality = mesh.quality;
  if (block->quality.size() != mesh.vertices.size()) block->quality.assign(mesh.vertices.size(), 1.0F);
  block->triangles = mesh.triangles;
  auto snapshot = std::make_shared<ModelSnapshot>();
  snapshot->blocks.push_back(std::move(block));
  return snapshot;
}

}  // namespace

Screen::Screen(std::string title, Clock& clock) : clock_(clock), trail_(std::make_shared<std::vector<Vec3f>>()) {
  options_.title = std::move(title);
}

Result<void> Screen::open_window() {
  ENAMEL_TRY_ASSIGN(window_, view::ViewerWindow::open(options_, clock_));
  return {};
}

void Screen::set_field(const calib::Rig& rig) {
  const calib::DepthRange depth = rig.depth_range.value_or(calib::DepthRange{});
  const calib::LensValues& c = rig.camera;
  options_.field = view::probe_field({c.width, c.height, c.fx, c.fy, c.cx, c.cy}, depth.near_mm, depth.far_mm);
  if (window_) window_->set_field(options_.field);
}

std::shared_ptr<const view::PreviewFrame> Screen::frame(const State& state) const {
  auto frame = std::make_shared<view::PreviewFrame>();
  frame->state = state.scan;
  frame->counters = state.counters;
  frame->message = state.message;
  frame->simulated = state.simulated;
  frame->rate_hz = state.rate_hz;
  frame->latency_ms = state.latency_ms;
  if (last_) {
    frame->burst = last_->burst;
    frame->placed = true;
    frame->track = last_->track.state;
    frame->track_overlap = last_->track.overlap;
    frame->T_model_cam = last_->track.T_model_cam;
    frame->surface_distance_mm = last_->surface_distance_mm;
    frame->live = last_->live;
    frame->model = last_->model;
  }
  frame->trail = trail_;
  return frame;
}

view::UserCommands Screen::refresh(const State& state, const std::shared_ptr<const stage::PreviewItem>& item) {
  if (item) {
    last_ = item;
    if (item->track.state != TrackState::kLost) {
      auto trail = std::make_shared<std::vector<Vec3f>>(*trail_);  // published trails are immutable
      trail->push_back(view::trail_point(item->track.T_model_cam, item->surface_distance_mm, options_.field));
      trail_ = std::move(trail);
    }
  }
  if (!window_) return {};
  window_->wait_frame();
  const view::UserCommands commands = window_->poll();
  // A frame that the driver refuses is left out; the next one is tried anew.
  static_cast<void>(window_->render(frame(state)));
  return commands;
}

Result<std::string> Screen::write_picture(const State& state, const Mesh* finished, const std::string& path) {
  auto last = std::make_shared<view::PreviewFrame>(*frame(state));
  if (finished != nullptr) last->model = snapshot_of(*finished);
  view::Picture picture;
  if (window_) {
    ENAMEL_TRY(window_->render(last));
    ENAMEL_TRY_ASSIGN(picture, window_->screenshot());
  } else {
    ENAMEL_TRY_ASSIGN(picture, view::draw_offscreen(*last, options_));
  }
  ENAMEL_TRY(view::write_png(picture, path));
  return picture.drawn_by;
}

}  // namespace enamel::app
