// What is not drawn again.
#include "viewer/scene/same_picture.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "tests/unit/viewer/tooth_scene.hpp"

namespace enamel::view::test {
namespace {

TEST(SamePicture, a_copy_is_the_same_and_every_change_is_another) {
  const ToothScene scene{.step_mm = 1.0};
  const auto frame = scene.frame(3, 20);
  EXPECT_TRUE(same_picture(*frame, PreviewFrame(*frame)));
  EXPECT_TRUE(same_picture(PreviewFrame{}, PreviewFrame{})) << "not a number is not a number";
  const std::vector<std::function<void(PreviewFrame&)>> changes{
      [](PreviewFrame& f) { ++f.burst.value; },
      [](PreviewFrame& f) { f.placed = false; },
      [](PreviewFrame& f) { f.track = TrackState::kLost; },
      [](PreviewFrame& f) { f.track_overlap = 0.4; },
      [](PreviewFrame& f) { f.T_model_cam.translation().x() += 1e-6; },
      [](PreviewFrame& f) { f.undetermined = true; },
      [](PreviewFrame& f) { f.rejected = "dark"; },
      [](PreviewFrame& f) { f.sight.trouble = SightTrouble::kFog; },
      [](PreviewFrame& f) { f.sight.x_px = 3; },
      [](PreviewFrame& f) { f.segment = 2; },
      [](PreviewFrame& f) { f.surface_distance_mm = 41; },
      [](PreviewFrame& f) { f.live = nullptr; },
      [](PreviewFrame& f) { f.model = nullptr; },
      [](PreviewFrame& f) { f.whole = f.model; },
      [](PreviewFrame& f) { f.T_model_return.translation().y() += 1; },
      [](PreviewFrame& f) { f.state = ScanState::kPaused; },
      [](PreviewFrame& f) { ++f.counters.captured; },
      [](PreviewFrame& f) { ++f.counters.shed; },
      [](PreviewFrame& f) { f.rate_hz += 0.1; },
      [](PreviewFrame& f) { f.latency_ms += 0.1; },
      [](PreviewFrame& f) { f.refined = 0.5; },
      [](PreviewFrame& f) { f.result = "known"; },
      [](PreviewFrame& f) { f.message = "the probe is gone"; },
      [](PreviewFrame& f) { f.simulated = !f.simulated; },
      [](PreviewFrame& f) { f.pipeline = std::make_shared<PipelineFigures>(); },
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    PreviewFrame other = *frame;
    changes[i](other);
    EXPECT_FALSE(same_picture(*frame, other)) << "change " << i;
  }
}

}  // namespace
}  // namespace enamel::view::test
