// What a frame of the preview costs by the size of the model: a row a size, as JSON. Draws into a window of its own
// Xvfb.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <vector>

#include "tests/unit/viewer/tooth_scene.hpp"
#include "tests/unit/viewer/xvfb.hpp"
#include "viewer/gl/viewer_window.hpp"

namespace enamel::bench {
namespace {

constexpr int kFrames = 24;

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Processor time of all threads: the software renderer's too, and other load does not count.
double process_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

int run(double step_mm) {
  SteadyClock clock;
  const view::test::ToothScene scene{.step_mm = step_mm, .block_mm = 0.8, .live_width = 640, .live_height = 480};
  const auto opened = view::ViewerWindow::open({}, clock);
  if (!opened) {
    std::fprintf(stderr, "%s\n", opened.error().message().c_str());
    return 1;
  }
  view::ViewerWindow& window = **opened;
  auto frame = scene.frame(19, 20);
  std::size_t model = 0;
  for (const auto& block : frame->model->blocks) model += block->triangles.size();
  for (int i = 0; i < 60 && (i < 12 || window.stats().blocks_pending > 0); ++i) {
    if (!window.render(std::make_shared<PreviewFrame>(*frame))) return 1;
  }
  std::vector<double> ms, core_ms;
  for (int i = 0; i < kFrames; ++i) {
    auto next = std::make_shared<PreviewFrame>(*frame);
    ++next->burst.value;
    next->T_model_cam = scene.pose(0.3 + 0.02 * i);
    const double before = process_ms();
    if (!window.render(std::move(next))) return 1;
    core_ms.push_back(process_ms() - before);
    ms.push_back(window.stats().last_frame_ms);
  }
  std::printf(
      "{\"model_triangles\": %zu, \"drawn_triangles\": %zu, \"sharpness\": %.2f, \"core_ms\": [%.1f, %.1f], "
      "\"wall_ms\": [%.1f, %.1f]}\n",
      model, window.stats().drawn_triangles, window.stats().sharpness, percentile(core_ms, 0), percentile(core_ms, 0.5),
      percentile(ms, 0), percentile(ms, 0.5));
  return 0;
}

}  // namespace
}  // namespace enamel::bench

int main(int argc, char** argv) {
  const enamel::view::test::Xvfb display;
  if (!display.problem().empty()) {
    std::fprintf(stderr, "%s\n", display.problem().c_str());
    return 1;
  }
  std::vector<double> steps_mm{0.5, 0.25, 0.1, 0.06, 0.04};
  if (argc > 1) steps_mm.assign(1, std::atof(argv[1]));
  for (const double step_mm : steps_mm) {
    if (const int rc = enamel::bench::run(step_mm); rc != 0) return rc;
  }
  return 0;
}
