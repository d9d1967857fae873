// The report of a calibration: what must be on the page, and that planted faults show.
#include "calib/report/report.hpp"

#include <gmock/gmock.h>

#include "calib/report/residual_plot.hpp"
#include "calib/report/svg.hpp"
#include "tests/support/calib_scene.hpp"

namespace enamel::calib {
namespace {

constexpr DepthRange kRange{40, 56};

class Report : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const auto scene = test::make_calib_scene(8, 6);
    Rng rng(8, 1, 1);
    target_ = scene.target;
    solution_ = solve(test::make_views(scene, {.centre_px = 0.005}, rng), scene.target, scene.nominal, {}).value();
    solution_.rejected.push_back({"bad <pose>", "blurred & dark"});
  }
  static std::string page(const Judgement& judgement) {
    ReportInput input;
    input.serial = "EN-8";
    input.solution = &solution_;
    input.judgement = &judgement;
    input.target = target_;
    input.range = kRange;
    return page_of("Calibration", report_sections(input).value());
  }
  static inline Solution solution_;
  static inline TargetDesign target_;
};

TEST_F(Report, states_verdict_poses_and_parameters) {
  const Judgement judgement = judge(solution_, {}, false, kRange);
  const std::string html = page(judgement);
  EXPECT_THAT(html,
              testing::HasSubstr(judgement.is_accepted ? "class=\"verdict accepted\"" : "class=\"verdict refused\""));
  EXPECT_THAT(html, testing::HasSubstr("EN-8"));
  EXPECT_THAT(html, testing::HasSubstr("<td>projector.k1</td>"));
  EXPECT_THAT(html, testing::HasSubstr("bad &lt;pose&gt;"));
  EXPECT_THAT(html, testing::HasSubstr("blurred &amp; dark"));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("<script")));
  EXPECT_THAT(html, testing::Not(testing::HasSubstr("http"))) << "self-contained";
  EXPECT_EQ(html, page(judgement)) << "same input, same bytes";
}

TEST_F(Report, a_refusal_shows_its_reason) {
  Solution worse = solution_;
  worse.result.rms_camera_px = 0.2;
  EXPECT_THAT(page(judge(worse, {}, false, kRange)), testing::HasSubstr("camera reprojection rms 0.2 px"));
}

TEST_F(Report, rows_of_poses_agree_with_the_residuals) {
  const auto rows = pose_rows(solution_, target_);
  ASSERT_EQ(rows.size(), solution_.poses.size());
  double squares = 0, dots = 0;
  for (const PoseRow& r : rows) {
    const double used = static_cast<double>(r.dots - r.outliers);
    squares += used * r.rms_camera_px * r.rms_camera_px;
    dots += used;
    EXPECT_GT(r.depth_mm, 35);
    EXPECT_LT(r.tilt_deg, 45);
  }
  EXPECT_NEAR(std::sqrt(squares / dots), solution_.result.rms_camera_px, 1e-9);
}

TEST(ResidualField, only_a_planted_pattern_is_marked) {
  Rng rng(2, 1, 1);
  std::vector<FieldArrow> noise, bent;
  for (int i = 0; i < 1500; ++i) {
    const Eigen::Vector2d at(640 * rng.uniform(), 480 * rng.uniform());
    const Eigen::Vector2d error(0.01 * rng.normal(), 0.01 * rng.normal());
    noise.push_back({at, error});
    bent.push_back({at, error + Eigen::Vector2d(at.x() > 480 ? 0.02 : 0.0, 0)});
  }
  const auto marked = [](const std::string& svg) {
    std::size_t n = 0;
    for (std::size_t at = svg.find("#c0392b"); at != std::string::npos; at = svg.find("#c0392b", at + 1)) ++n;
    return n / 3 - 1;  // three strokes an arrow, one arrow in the legend
  };
  EXPECT_LE(marked(residual_field(noise, 640, 480)), 2U);  // 96 tests at three sigma: 0.3 expected
  EXPECT_GE(marked(residual_field(bent, 640, 480)), 11U);  // a quarter of 48 cells
}

TEST(ResidualField, nothing_to_draw_is_no_crash) {
  EXPECT_THAT(residual_field({}, 640, 480), testing::HasSubstr("</svg>"));
  EXPECT_THAT(plane_map({}, 640, 480, 1).value(), testing::HasSubstr("data:image/png;base64,iVBORw0KGgo"));
}

TEST(Svg, numbers_of_legends_are_round) {
  EXPECT_DOUBLE_EQ(round_number(0.037), 0.02);
  EXPECT_DOUBLE_EQ(round_number(7.3), 5);
  EXPECT_DOUBLE_EQ(round_number(1.0), 1);
}

}  // namespace
}  // namespace enamel::calib
