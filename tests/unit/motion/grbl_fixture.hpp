// Axes on a simulated controller, fast enough for tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "host/motion/grbl_axes.hpp"
#include "tests/support/grbl_model.hpp"

namespace enamel::motion {

constexpr Nanoseconds kMove = std::chrono::seconds(6);

inline GrblProfile quick_profile() {
  GrblProfile profile;
  profile.feed_deg_per_s = 600.0;
  profile.settle_ms = 20.0;
  profile.banner_ms = 600.0;
  return profile;
}

/// Opened and, unless told otherwise, homed.
struct GrblBench {
  explicit GrblBench(test::GrblModelSetup setup = {}, GrblProfile profile = quick_profile(), bool homes = true)
      : model(std::move(setup)) {
    auto opened = GrblAxes::open(model.port(), profile, clock);
    EXPECT_TRUE(opened) << opened.error().message();
    if (!opened) return;
    axes = std::move(*opened);
    if (homes) {
      EXPECT_TRUE(axes->home(kMove));
    }
  }
  SteadyClock clock;
  test::GrblModel model;
  std::unique_ptr<GrblAxes> axes;
};

}  // namespace enamel::motion
