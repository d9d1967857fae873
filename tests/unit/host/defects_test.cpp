// Each detector of host/defects against surfaces drawn by seed: it sees its fault, and tells nothing on sound ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>

#include "host/defects/inspect.hpp"
#include "host/defects/report_defects.hpp"
#include "tests/unit/host/drawn_surfaces.hpp"

namespace enamel::host {
namespace {

using drawn::Draw;
using drawn::Relief;

constexpr std::uint64_t kDraws = 16;
constexpr double kSeen = 0.95, kTold = 0.01;

/// A scan and where it is wrong.
struct Case {
  Mesh mesh;
  SurveyResult survey;
  Marks marks;
  Vec3d fault = Vec3d::Zero();
  double near_mm = std::numeric_limits<double>::infinity();
};
using Make = std::function<Case(Draw&, bool faulty)>;

/// Every detector looks at every case: what another class tells of a sound scan counts too.
void expect_told_apart(DefectClass kind, const Make& make) {
  std::uint64_t seen = 0, told = 0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    for (const bool faulty : {true, false}) {
      Draw draw(2 * seed + (faulty ? 1 : 0));
      const Case c = make(draw, faulty);
      const SurveyResult* survey = c.survey.facts.empty() ? nullptr : &c.survey;
      const auto defects = inspect({c.mesh, survey, &c.marks});
      if (!faulty) {
        told += defects.empty() ? 0U : 1U;
        if (!defects.empty()) ADD_FAILURE() << "seed " << seed << ": " << defect_line(defects.front());
        continue;
      }
      const bool is_seen = std::ranges::any_of(defects, [&](const Defect& d) {
        return d.kind == kind && (d.p_model_mm - c.fault).norm() <= c.near_mm && !d.words.empty() &&
               d.confidence >= 0.5;
      });
      seen += is_seen ? 1U : 0U;
    }
  }
  EXPECT_GE(static_cast<double>(seen), kSeen * static_cast<double>(kDraws));
  EXPECT_LE(static_cast<double>(told), kTold * static_cast<double>(kDraws));
}

Case on_ground(Draw& draw, const drawn::Ground& g = {}) {
  const Relief relief(draw);
  Case out;
  out.mesh = drawn::ground(draw, relief, g);
  return out;
}

TEST(Defects, a_hole_is_told_and_a_slit_is_not) {
  expect_told_apart(DefectClass::kHole, [](Draw& draw, bool faulty) {
    const double radius = draw.uniform(0.7, 1.5), x = draw.uniform(-2.5, 2.5), y = draw.uniform(-2.5, 2.5);
    drawn::Ground g;
    g.keep = [=](const Vec3d& p) {
      if (faulty) return std::hypot(p.x() - x, p.y() - y) > radius;
      return std::abs(p.x() - x) > 0.15 || std::abs(p.y() - y) > 2.0;  // a contact of two teeth
    };
    Case out = on_ground(draw, g);
    out.fault = {x, y, 0};
    out.near_mm = 3;
    return out;
  });
}

TEST(Defects, a_web_is_told_and_a_tooths_edge_is_not) {
  expect_told_apart(DefectClass::kBridge, [](Draw& draw, bool faulty) {
    Case out = on_ground(draw);
    drawn::add_wall(draw, out.mesh, faulty ? draw.uniform(0.15, 0.45) : draw.uniform(0.9, 2));
    return out;
  });
}

TEST(Defects, noise_is_told_and_form_is_not) {
  expect_told_apart(DefectClass::kNoise, [](Draw& draw, bool faulty) {
    drawn::Ground g;
    g.noise_mm = faulty ? draw.uniform(0.018, 0.05) : draw.uniform(0.0005, 0.0035);
    return on_ground(draw, g);
  });
}

/// Stump, shoulder and root; the finish line has a radius.
TEST(Defects, a_blurred_finish_line_is_told_and_a_sharp_one_is_not) {
  expect_told_apart(DefectClass::kFinishLine, [](Draw& draw, bool faulty) {
    const double edge = faulty ? draw.uniform(0.4, 0.7) : draw.uniform(0.03, 0.16);
    const auto stump = static_cast<float>(draw.uniform(2.5, 3.8)),
               shoulder = static_cast<float>(draw.uniform(0.9, 1.3));
    const auto high = static_cast<float>(draw.uniform(3, 5));
    const auto profile = drawn::rounded({{0.02F, 0},
                                         {stump, 0},
                                         {stump + 0.3F, -high},
                                         {stump + 0.3F + shoulder, -high},
                                         {stump + 0.3F + shoulder, -high - 3}},
                                        {0, 0.5, 0.3, edge, 0}, 0.08);
    const double oval = draw.uniform(0.9, 1.1);
    Case out;
    out.mesh = drawn::turned(draw, profile, 0.002,
                             [=](double a, double rho, double) { return rho * (1 + (oval - 1) * std::cos(2 * a)); });
    Pose T = Pose::Identity();
    drawn::move(draw, out.mesh, T);
    out.marks.preparations.push_back(
        {T * Vec3d{draw.uniform(-0.4, 0.4), draw.uniform(-0.4, 0.4), draw.uniform(-0.2, 0.2)}, 8});
    return out;
  });
}

TEST(Defects, a_scan_body_of_another_size_is_told_and_a_right_one_is_not) {
  expect_told_apart(DefectClass::kScanBody, [](Draw& draw, bool faulty) {
    const ScanBodyForm form{draw.uniform(1.8, 2.6), draw.uniform(7, 9), 0};
    const double sign = draw.uniform(0, 1) < 0.5 ? -1 : 1;
    const double error = faulty ? sign * draw.uniform(0.08, 0.2) : draw.uniform(-0.015, 0.015);
    const auto r = static_cast<float>(form.radius_mm + error), h = static_cast<float>(form.height_mm);
    const auto profile = drawn::rounded({{0.02F, 0}, {r, 0}, {r, -h}}, {0, 0.15, 0}, 0.08);
    Case out;
    out.mesh = drawn::turned(draw, profile, 0.004, [](double, double rho, double) { return rho; });
    Pose T = Pose::Identity();
    drawn::move(draw, out.mesh, T);
    out.marks.scan_bodies.push_back(
        {T * Vec3d{draw.uniform(-0.4, 0.4), draw.uniform(-0.4, 0.4), draw.uniform(-0.2, 0.2)}, form});
    return out;
  });
}

/// What bursts see of the ground: a camera above it that goes along x, its pixels as coarse as the cells.
class Bursts {
 public:
  Bursts() {
    camera_.width = kWidth;
    camera_.height = kHeight;
    camera_.fx = camera_.fy = kFocal;
    camera_.cx = 0.5 * (kWidth - 1);
    camera_.cy = 0.5 * (kHeight - 1);
  }
  [[nodiscard]] const calib::LensValues& camera() const { return camera_; }
  [[nodiscard]] static Pose pose(double x_mm) {
    Pose out = Pose::Identity();
    out.linear() = Eigen::AngleAxisd(std::numbers::pi, Vec3d::UnitX()).toRotationMatrix();  // looks down
    out.translation() = Vec3d(x_mm, 0, kAwayMm);
    return out;
  }
  /// height(x, y), met by every ray after a few rounds.
  [[nodiscard]] SurfacePatch patch(const Pose& T_model_cam, Draw& draw,
                                   const std::function<double(double, double)>& height) const {
    SurfacePatch out;
    out.points = Map<Vec3f>(kWidth, kHeight, Vec3f::Zero());
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const Vec3d ray((u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1);
        double z = kAwayMm;
        for (int i = 0; i < 4; ++i) {
          const Vec3d p = T_model_cam * Vec3d(z * ray);
          z += p.z() - height(p.x(), p.y());
        }
        out.points(u, v) = ((z + draw.normal(0.008)) * ray).cast<float>();
      }
    }
    return out;
  }

 private:
  static constexpr int kWidth = 64, kHeight = 64;
  static constexpr double kFocal = 266, kAwayMm = 48;
  calib::LensValues camera_{};
};

struct Seen {
  int bursts = 12;
  double from_mm = -1, to_mm = 1;
  std::function<double(int, double, double)> raised = [](int, double, double) { return 0.0; };
  std::function<Sight(int)> sight = [](int) { return Sight{}; };
  std::function<bool(int, const Vec3f&)> lost = [](int, const Vec3f&) { return false; };
};

Case seen_by_bursts(Draw& draw, const Seen& how) {
  const Relief relief(draw);
  Case out;
  out.mesh = drawn::ground(draw, relief);
  const Bursts bursts;
  Survey survey(out.mesh, bursts.camera());
  for (int n = 0; n < how.bursts; ++n) {
    const Pose T = Bursts::pose(how.from_mm + (how.to_mm - how.from_mm) * n / how.bursts);
    SurfacePatch patch = bursts.patch(T, draw, [&](double x, double y) { return relief(x, y) + how.raised(n, x, y); });
    for (Vec3f& p : patch.points.pixels())
      if (how.lost(n, p)) p = Vec3f::Constant(std::numeric_limits<float>::quiet_NaN());
    survey.add(patch, T, how.sight(n));
  }
  out.survey = survey.result();
  return out;
}

TEST(Defects, passes_that_disagree_are_told_and_noise_between_them_is_not) {
  expect_told_apart(DefectClass::kStitching, [](Draw& draw, bool faulty) {
    const double x = draw.uniform(-2, 2), y = draw.uniform(-2, 2), radius = draw.uniform(1.2, 2.5);
    const double step = faulty ? draw.uniform(0.14, 0.35) : draw.uniform(0, 0.025);
    const int from = static_cast<int>(draw.uniform(4, 8));
    Seen how;
    how.raised = [=](int n, double px, double py) {
      return n >= from && std::hypot(px - x, py - y) < radius ? step : 0.0;
    };
    Case out = seen_by_bursts(draw, how);
    out.fault = {x, y, 0};
    out.near_mm = 3;
    return out;
  });
}

TEST(Defects, surface_that_few_bursts_saw_is_told_and_its_rim_is_not) {
  expect_told_apart(DefectClass::kReliability, [](Draw& draw, bool faulty) {
    const double half = draw.uniform(1.9, 2.6);
    const int few = static_cast<int>(draw.uniform(1, 4));
    Seen how;
    how.lost = [=](int n, const Vec3f& p) {  // in the camera's frame, which goes along by a mm
      const auto out = static_cast<double>(std::max(std::abs(p.x()), std::abs(p.y())));
      return n >= few && (faulty ? out < half : out > 3.6);
    };
    return seen_by_bursts(draw, how);
  });
}

TEST(Defects, mirror_light_is_told_and_a_single_glint_is_not) {
  expect_told_apart(DefectClass::kHumidity, [](Draw& draw, bool faulty) {
    const int bursts = faulty ? static_cast<int>(draw.uniform(3, 9)) : static_cast<int>(draw.uniform(0, 3));
    const auto x = static_cast<float>(draw.uniform(20, 40)), y = static_cast<float>(draw.uniform(20, 40));
    Seen how;
    how.sight = [=](int n) {
      Sight out;
      if (n >= bursts) return out;
      out.trouble = SightTrouble::kGlare;
      out.x_px = x + static_cast<float>(n);
      out.y_px = y;
      return out;
    };
    return seen_by_bursts(draw, how);
  });
}

TEST(Defects, what_passed_is_told_and_a_few_lost_points_are_not) {
  expect_told_apart(DefectClass::kTissue, [](Draw& draw, bool faulty) {
    Case out = seen_by_bursts(draw, {});
    out.survey.passed_mm2 = 0.2;
    const auto bursts = static_cast<std::uint32_t>(draw.uniform(2, 5));
    const int points = faulty ? static_cast<int>(draw.uniform(30, 200)) : static_cast<int>(draw.uniform(0, 15));
    for (std::uint32_t n = 0; n < bursts; ++n) {
      for (int i = 0; i < points; ++i) {
        const Vec3d p(draw.uniform(-2, 2), draw.uniform(-2, 2), 3);
        out.survey.passed.push_back({n, p.cast<float>()});
      }
    }
    return out;
  });
}

TEST(Defects, the_same_scan_gives_the_same_list) {
  Draw a(5), b(5);
  drawn::Ground g;
  g.keep = [](const Vec3d& p) { return p.head<2>().norm() > 1; };
  EXPECT_EQ(defects_json(inspect({on_ground(a, g).mesh})), defects_json(inspect({on_ground(b, g).mesh})));
}

TEST(Defects, an_empty_mesh_has_none) { EXPECT_TRUE(inspect({Mesh{}}).empty()); }

TEST(ReportDefects, what_bursts_told_comes_back_and_the_rest_does_not) {
  std::vector<Defect> all(2);
  all[0] = {DefectClass::kHole, {1, 2, 3}, 2, 2, 1, 0.7, "scan"};
  all[1] = {DefectClass::kStitching, {4, 5, 6}, 3, 150, 80, 0.6, "cut"};
  const auto back = surveyed_defects(R"({"defects": )" + defects_json(all) + "}");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), 1U);
  EXPECT_EQ(defect_line(back->front()), defect_line(all[1]));
  EXPECT_FALSE(surveyed_defects("no report"));
  const auto spoilt = surveyed_defects(R"({"defects": [3, {"class": "stitching"}, {"class": 1}, null]})");
  ASSERT_TRUE(spoilt);
  EXPECT_TRUE(spoilt->empty());
}

}  // namespace
}  // namespace enamel::host
