#include "host/app/screen.hpp"

#include <utility>

#include "viewer/gl/offscreen.hpp"
#include "viewer/gl/picture.hpp"

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
  block->soft = mesh.soft;
  auto snapshot = std::make_shared<ModelSnapshot>();
  snapshot->blocks.push_back(std::move(block));
  return snapshot;
}

}  // namespace

Screen::Screen(std::string title, Clock& clock) : clock_(clock), trail_(options_.field) {
  options_.title = std::move(title);
}

Result<void> Screen::try_display(Clock& clock) {
  view::ViewerOptions hidden;
  hidden.visible = false;
  ENAMEL_TRY(view::ViewerWindow::open(hidden, clock));
  return {};
}

Result<void> Screen::open_window() {
  ENAMEL_TRY_ASSIGN(window_, view::ViewerWindow::open(options_, clock_));
  return {};
}

void Screen::set_field(const calib::Rig& rig) {
  const calib::DepthRange depth = rig.depth_range.value_or(calib::DepthRange{});
  const calib::LensValues& c = rig.camera;
  options_.field = view::probe_field({c.width, c.height, c.fx, c.fy, c.cx, c.cy}, depth.near_mm, depth.far_mm);
  trail_ = view::Trail(options_.field);
  if (window_) window_->set_field(options_.field);
}

void Screen::add(std::shared_ptr<const BurstPreview> burst) {
  if (!burst) return;
  newest_ = std::move(burst);
  trail_.add(*newest_);
  newest_shown_ = !newest_->rejected.empty();  // of a burst that was rejected there is nothing to see
}

std::shared_ptr<PreviewFrame> Screen::frame(PreviewFrame session) const {
  auto frame = std::make_shared<PreviewFrame>(std::move(session));
  if (newest_) static_cast<BurstPreview&>(*frame) = *newest_;
  frame->trail = trail_.points();
  return frame;
}

view::UserCommands Screen::draw(PreviewFrame session) {
  if (!window_) return {};
  const bool is_due = window_->wait_frame();
  const view::UserCommands commands = window_->poll();
  if (!is_due) return commands;
  // A frame that the driver refuses is left out; the next one is tried anew.
  const std::uint64_t before = window_->stats().frames_drawn;
  static_cast<void>(window_->render(frame(std::move(session))));
  const view::ViewerStats now = window_->stats();
  if (now.frames_drawn > before && !newest_shown_) {
    newest_shown_ = true;
    shown_ = Shown{newest_->burst, now.last_shown};
  }
  return commands;
}

Result<std::string> Screen::write_picture(PreviewFrame session, const Mesh& mesh, const std::string& path) {
  const auto last = frame(std::move(session));
  last->model = snapshot_of(mesh);
  last->whole = nullptr;  // the finished model, whatever was scanned last
  last->segment = kModelSegment;
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
