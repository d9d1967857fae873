// Fringe orders by the model: what it decides, what it must leave alone, and what it finds wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/decode/burst_decoder.hpp"
#include "pipeline/model/guide/complete.hpp"
#include "pipeline/model/guide/model_guide.hpp"
#include "pipeline/register/icp/patch_view.hpp"
#include "tests/support/tooth_steps.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::test {
namespace {

constexpr int kWidth = 320, kHeight = 240, kViewStride = 2;
constexpr double kTurn = 2 * std::numbers::pi;

Pose some_pose() {
  Pose T = Pose::Identity();
  T.rotate(Eigen::AngleAxisd(0.3, Vec3d(1, 2, -1).normalized()));
  T.translation() = Vec3d(4, -7, 11);
  return T;
}

SurfacePatch patch_of(const Map<double>& depth_mm, const pipeline::RayDepth& rays) {
  SurfacePatch patch;
  patch.depth_mm = patch.sigma_mm = Map<float>(kWidth, kHeight, 0.01F);
  patch.points = patch.normals = Map<Vec3f>(kWidth, kHeight, Vec3f::Zero());
  Map<float> inverse_depth(kWidth, kHeight);
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    const auto z = static_cast<float>(depth_mm[i]);
    patch.depth_mm[i] = z;
    inverse_depth[i] = 1 / z;
    patch.points[i] = {rays.rays.x[i] * z, rays.rays.y[i] * z, z};
  }
  std::vector<float> scratch;
  pipeline::compute_normals(rays, inverse_depth, patch.sigma_mm, {}, scratch, patch.normals);
  patch.valid_px = depth_mm.size();
  return patch;
}

/// A gently tilted plane before the rig, and the model that knows it.
class Guide : public ::testing::Test {
 protected:
  calib::Rig rig = cropped_rig(kWidth, kHeight);
  pipeline::BurstDecoder decoder = pipeline::BurstDecoder::make(rig).value();
  const pipeline::RayDepth& rays = decoder.rays();
  pipeline::ModelGuide guide{decoder.shared_rays(), rig.camera, {}};
  Map<double> plane = [] {
    Map<double> z(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) z(u, v) = 48 + 0.004 * u - 0.002 * v;
    return z;
  }();
  SurfacePatch patch = patch_of(plane, rays);
  ModelView view = pipeline::view_from_patch(patch, some_pose(), rig.camera, kViewStride);

  /// Phase at which the ray of a pixel meets depth z, by bisection of the baked cubic.
  [[nodiscard]] float phase_at(std::size_t i, double z_mm) const {
    float low = std::min(rays.phase_near_rad[i], rays.phase_far_rad[i]) - 1, high = low + 60;
    const bool rising = rays.inverse_depth_slope(i, low) > 0;
    for (int k = 0; k < 60; ++k) {
      const float middle = 0.5F * (low + high);
      const bool above = static_cast<double>(rays.inverse_depth(i, middle)) > 1 / z_mm;
      (above == rising ? high : low) = middle;
    }
    return low;
  }

  /// Depth of the plane's pixel one order further on.
  [[nodiscard]] float next_order_mm(std::size_t i) const {
    for (const double step : {kTurn, -kTurn}) {
      const float q = rays.inverse_depth(i, phase_at(i, plane[i]) + static_cast<float>(step));
      if (q * rays.near_mm <= 1 && q * rays.far_mm >= 1) return 1 / q;
    }
    ADD_FAILURE() << "the depth range holds one order only";
    return 0;
  }

  /// A block of the plane whose phase is known but for `k` wrap counts.
  [[nodiscard]] RelativeSurface block(int k) const {
    RelativeSurface out;
    out.regions.push_back({-3, 3, 40 * 30});
    for (int v = 100; v < 130; ++v) {
      out.spans.push_back({v, 150, 190, 0, 5});
      for (int u = 150; u < 190; ++u) {
        out.phase_rad.push_back(phase_at(plane.index(u, v), plane(u, v)) - static_cast<float>(kTurn * (5 + k)));
        out.sigma_rad.push_back(0.03F);
      }
    }
    return out;
  }

  void move_block(const std::function<float(std::size_t)>& depth_mm) {
    for (int v = 60; v < 100; ++v) {
      for (int u = 40; u < 100; ++u) {
        const std::size_t i = plane.index(u, v);
        patch.depth_mm[i] = depth_mm(i);
      }
    }
  }
};

TEST_F(Guide, finds_the_order_of_a_planted_region) {
  for (const int k : {-2, 0, 1, 3}) {
    const auto orders = guide.decide(block(k), view, some_pose());
    EXPECT_EQ(orders, std::vector<std::int32_t>(40 * 30, k));
  }
}

TEST_F(Guide, adds_the_region_where_the_surface_is) {
  const RelativeSurface relative = block(2);
  SurfacePatch holed = patch;
  for (const auto& s : relative.spans)
    for (int u = s.begin; u < s.end; ++u) holed.depth_mm(u, s.row) = std::nanf("");
  const auto orders = guide.decide(relative, view, some_pose());
  EXPECT_EQ(pipeline::add_decided(relative, orders, rays, {}, holed), 40U * 30U);
  for (const auto& s : relative.spans) {
    for (int u = s.begin; u < s.end; ++u) {
      EXPECT_NEAR(static_cast<double>(holed.depth_mm(u, s.row)), plane(u, s.row), 1e-3);
      EXPECT_TRUE(holed.normals(u, s.row).allFinite());
      EXPECT_GT(holed.sigma_mm(u, s.row), 0.0F);
    }
  }
}

bool none(const std::vector<std::int32_t>& orders) {
  return std::all_of(orders.begin(), orders.end(), [](std::int32_t k) { return k == kOpenOrder; });
}

TEST_F(Guide, leaves_alone_what_the_model_does_not_show) {
  EXPECT_TRUE(none(guide.decide(block(1), ModelView{}, some_pose())));
  ModelView elsewhere = view;
  for (Vec3f& p : elsewhere.points.pixels()) p.setConstant(std::nanf(""));
  EXPECT_TRUE(none(guide.decide(block(1), elsewhere, some_pose())));
  // A surface between two orders is another surface.
  const ModelView between =
      pipeline::view_from_patch(patch, some_pose() * Eigen::Translation3d(0, 0, 1), rig.camera, 2);
  EXPECT_TRUE(none(guide.decide(block(1), between, some_pose())));
}

// What a jump of exactly one fringe leaves: a region that looks like one surface and is two.
TEST_F(Guide, spans_of_a_torn_region_go_their_own_way) {
  RelativeSurface torn = block(1);
  for (std::size_t n = torn.phase_rad.size() / 2; n < torn.phase_rad.size(); ++n)
    torn.phase_rad[n] += static_cast<float>(kTurn);
  const auto orders = guide.decide(torn, view, some_pose());
  for (std::size_t n = 0; n < orders.size(); ++n) ASSERT_EQ(orders[n], n < orders.size() / 2 ? 1 : 0) << n;
}

TEST_F(Guide, a_span_that_is_two_stays_open) {
  RelativeSurface torn = block(0);
  for (std::size_t n = 0; n < torn.phase_rad.size(); ++n)
    torn.phase_rad[n] += n % 40 < 20 ? static_cast<float>(kTurn) : 0;
  EXPECT_TRUE(none(guide.decide(torn, view, some_pose())));
}

/// How many pixels at the end of each row of the block stay open; the others must have order 1.
void expect_open_at_ends(const std::vector<std::int32_t>& orders, std::size_t open) {
  for (std::size_t n = 0; n < orders.size(); ++n)
    ASSERT_EQ(orders[n], n % 40 < 40 - open ? 1 : kOpenOrder) << "column " << n % 40;
}

TEST_F(Guide, a_narrow_strip_that_the_model_does_not_show_stays_open) {
  const auto blank_from = [&](int u) {
    ModelView out = view;
    for (int j = 0; j < out.points.height(); ++j)
      for (int i = u / kViewStride; i < out.points.width(); ++i) out.points(i, j).setConstant(std::nanf(""));
    return out;
  };
  expect_open_at_ends(guide.decide(block(1), blank_from(188), some_pose()), 3);
  expect_open_at_ends(guide.decide(block(1), blank_from(178), some_pose()), 0);  // new surface, beside what is known
}

TEST_F(Guide, where_the_models_edge_fits_two_orders_pixels_stay_open) {
  SurfacePatch stepped = patch;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 190; u < kWidth; ++u) {
      const std::size_t i = plane.index(u, v);
      stepped.points[i] *= next_order_mm(i) / static_cast<float>(plane[i]);
    }
  }
  const ModelView edge = pipeline::view_from_patch(stepped, some_pose(), rig.camera, kViewStride);
  expect_open_at_ends(guide.decide(block(1), edge, some_pose()), 3);
  expect_open_at_ends(guide.decide(block(1), view, some_pose()), 0);
}

TEST_F(Guide, a_right_burst_contradicts_nothing) {
  const OrderCheck all = guide.check(patch, view, some_pose());
  EXPECT_GT(all.checked, 4000U);
  EXPECT_EQ(all.contradicting, 0U);
  EXPECT_FALSE(all.suspect);
  EXPECT_EQ(guide.withdraw(view, some_pose(), patch), 0U);
}

TEST_F(Guide, a_wrong_order_is_found_and_withdrawn) {
  move_block([this](std::size_t i) { return next_order_mm(i); });
  const OrderCheck all = guide.check(patch, view, some_pose());
  EXPECT_NEAR(static_cast<double>(all.contradicting), 60 * 40 / 16.0, 8);
  EXPECT_TRUE(all.suspect);
  const std::size_t withdrawn = guide.withdraw(view, some_pose(), patch);
  EXPECT_NEAR(static_cast<double>(withdrawn), 60 * 40, 60);
  EXPECT_EQ(patch.valid_px, plane.size() - withdrawn);
  EXPECT_TRUE(std::isnan(patch.depth_mm(70, 80)));
  EXPECT_FALSE(std::isnan(patch.depth_mm(200, 80)));
}

TEST_F(Guide, new_surface_before_the_model_is_no_contradiction) {
  move_block([this](std::size_t i) { return static_cast<float>(plane[i]) - 1; });
  const OrderCheck all = guide.check(patch, view, some_pose());
  EXPECT_EQ(all.contradicting, 0U);
  EXPECT_EQ(guide.withdraw(view, some_pose(), patch), 0U);
}

// Rows of teeth in mode T: isolated patches and steps of a fringe that the code alone leaves open, and a model that has
// seen the place, placed 30 um beside the truth as registration may be.
TEST(GuideOfTeeth, the_model_decides_most_of_what_the_code_leaves_open) {
  const calib::Rig rig = cropped_rig(kWidth, kHeight);
  const auto decoder = pipeline::BurstDecoder::make(rig).value();
  const pipeline::ModelGuide guide(decoder.shared_rays(), rig.camera, {});
  std::size_t open = 0, added = 0, wrong = 0, contradicting = 0, wrong_before = 0, wrong_after = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const ToothSteps steps = make_tooth_steps(rig, seed);
    const SyntheticBurst burst = render(
        rig, [&](int u, int v) { return steps.depth_mm(u, v); }, steps.options(seed));
    pipeline::DecodedBurst decoded = decoder.decode(burst.frames.view());
    if (!decoded.accepted()) continue;
    const SurfacePatch truth = patch_of(burst.depth_mm, decoder.rays());
    const ModelView view = pipeline::view_from_patch(truth, some_pose(), rig.camera, kViewStride);
    const Pose placed = some_pose() * Eigen::Translation3d(0.02, 0.01, 0.02);
    const auto off = [&](const SurfacePatch& p, std::size_t i) {
      return std::abs(static_cast<double>(p.depth_mm[i]) - burst.depth_mm[i]) > 1;
    };
    const SurfacePatch before = decoded.patch;
    contradicting += guide.withdraw(view, placed, decoded.patch);
    const auto orders = guide.decide(decoded.relative, view, placed);
    open += decoded.relative.phase_rad.size();
    added += pipeline::add_decided(decoded.relative, orders, decoder.rays(), {}, decoded.patch);
    for (std::size_t i = 0; i < before.depth_mm.size(); ++i) {
      wrong_before += off(before, i) ? 1U : 0U;
      wrong_after += off(decoded.patch, i) ? 1U : 0U;
      wrong += std::isnan(before.depth_mm[i]) && off(decoded.patch, i) ? 1U : 0U;
    }
  }
  EXPECT_GT(open, 10000U);
  EXPECT_GT(added * 10, open * 7) << added << " of " << open;
  EXPECT_LE(wrong * 200, added) << wrong << " of " << added;
  EXPECT_GT(contradicting, 0U);
  EXPECT_LE(wrong_after, wrong_before);
}

}  // namespace
}  // namespace enamel::test
