// The baseline that the code is compared with must itself be sound where it can be.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/marker_baseline.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

struct Placed {
  std::size_t placed = 0, wrong = 0;
};

Placed count_orders(const calib::Rig& rig, const test::SyntheticBurst& scene) {
  const test::MarkerOrders orders = test::orders_from_marker(rig, scene.frames.view());
  Placed out;
  for (std::size_t i = 0; i < orders.order.size(); ++i) {
    if (orders.order[i] < 0) continue;
    ++out.placed;
    const double middle = 2 * std::numbers::pi * (orders.order[i] + 0.5);
    out.wrong += std::abs(scene.phase_rad[i] - middle) > std::numbers::pi + 0.3 ? 1U : 0U;
  }
  return out;
}

calib::Rig marked_rig() {
  calib::Rig rig = test::cropped_rig(480, 60);
  rig.patterns.mode = calib::PatternMode::kSingle;
  rig.patterns.polarity_code.clear();
  rig.patterns.marker_fringe = 17;
  return rig;
}

TEST(MarkerBaseline, plane_is_counted_from_its_marker) {
  const calib::Rig rig = marked_rig();
  const Placed p = count_orders(rig, test::render(rig, test::flat(48), test::noisy()));
  EXPECT_GT(p.placed, 480U * 60U * 9 / 10);
  EXPECT_EQ(p.wrong, 0U);
}

TEST(MarkerBaseline, surface_without_the_marker_stays_unplaced) {
  calib::Rig rig = marked_rig();
  const auto scene = test::render(rig, test::flat(48), test::noisy());
  rig.patterns.marker_fringe = 0;  // not in view: the fringe that looks like it is then taken for it, wrongly
  EXPECT_GT(count_orders(rig, scene).wrong, 0U);
  calib::Rig unseen = marked_rig();
  unseen.patterns.marker_fringe = 0;
  EXPECT_EQ(count_orders(unseen, test::render(unseen, test::flat(48), test::noisy())).placed, 0U);
}

TEST(MarkerBaseline, far_side_of_a_gap_is_lost) {  // what the code is for
  const calib::Rig rig = marked_rig();
  test::SceneOptions o = test::noisy();
  o.light = [](int u, int) { return u >= 300 && u < 310 ? 0.0 : 1.0; };
  const Placed p = count_orders(rig, test::render(rig, test::flat(48), o));
  EXPECT_LT(p.placed, 480U * 60U * 8 / 10);
  EXPECT_EQ(p.wrong, 0U);
}

}  // namespace
}  // namespace enamel::pipeline
