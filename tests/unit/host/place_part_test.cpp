// Drawn jaws in a drawn bite: each part scanned in a frame of its own, and found again; what is not of the case
// refused.
#include "host/cases/place_part.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <vector>

#include "host/cases/case_file.hpp"
#include "tests/unit/host/drawn_jaws.hpp"

namespace enamel::host {
namespace {

constexpr double kNoise_mm = 0.006;  // of a fused mesh's vertices
constexpr double kFrom_mm = 2, kTo_mm = 36;

bool from_above(const Vec3d& /*at*/, const Vec3d& normal) { return normal.z() > -0.3; }

/// One patient's parts and where they truly lie: T_NAME maps the lower jaw's coordinates to the scan's.
struct Patient {
  Pose T_lower, T_upper, T_bite;
  Pose T_lower_upper;  ///< of the bodies
  Mesh lower_body, upper_body;
  std::unique_ptr<const LaidPart> lower, upper, bite;
};

Patient patient(std::uint64_t seed) {
  const auto s = static_cast<unsigned>(seed);
  std::mt19937 draw(s);
  Patient out;
  out.T_lower = drawn_pose(draw);
  out.T_upper = drawn_pose(draw);
  out.T_bite = drawn_pose(draw);
  out.lower_body = jaw_mesh(twin::JawSide::kLower, seed, 0.3, kFrom_mm, kTo_mm);
  // The left side above: turned over, it lies on the lower's right.
  out.upper_body = jaw_mesh(twin::JawSide::kUpper, seed, 0.3, -kTo_mm, -kFrom_mm);
  out.T_lower_upper = upper_over_lower(out.lower_body, out.upper_body);
  out.lower = std::make_unique<const LaidPart>(scanned(out.lower_body, from_above, kNoise_mm, s, out.T_lower));
  out.upper = std::make_unique<const LaidPart>(scanned(out.upper_body, from_above, kNoise_mm, s + 1, out.T_upper));
  // Meshed anew: no vertex of the bite's scan is one of a jaw's.
  const Mesh both = joined(jaw_mesh(twin::JawSide::kLower, seed, 0.27, kFrom_mm, kTo_mm),
                           moved(jaw_mesh(twin::JawSide::kUpper, seed, 0.27, -kTo_mm, -kFrom_mm), out.T_lower_upper));
  out.bite = std::make_unique<const LaidPart>(scanned(both, from_the_cheek, kNoise_mm, s + 2, out.T_bite));
  return out;
}

const Patient& first() {
  static const Patient one = patient(1);
  return one;
}

double worst_mm(const Mesh& body, const Pose& off) {
  double worst = 0;
  for (const Vec3f& v : body.vertices) worst = std::max(worst, (off * v.cast<double>() - v.cast<double>()).norm());
  return worst;
}

/// Facets of 0.3 mm lie up to so far inside of one another's roundings; all else is noise, averaged by thousands.
constexpr double kFacet_mm = 0.008;

TEST(PlacePart, bite_is_found_on_both_jaws) {
  const Patient& p = first();
  const auto lower = place_part(*p.bite, *p.lower, {});
  const auto upper = place_part(*p.bite, *p.upper, {});
  ASSERT_TRUE(lower) << lower.error().detail;
  ASSERT_TRUE(upper) << upper.error().detail;
  const double off_lower = worst_mm(p.lower_body, p.T_lower.inverse() * lower->T_fixed_moving * p.T_bite);
  const double off_upper =
      worst_mm(p.upper_body, p.T_upper.inverse() * upper->T_fixed_moving * p.T_bite * p.T_lower_upper);
  EXPECT_LT(off_lower, kFacet_mm + 3 * lower->far_sigma_mm);
  EXPECT_LT(off_upper, kFacet_mm + 3 * upper->far_sigma_mm);
  for (const auto* placed : {&*lower, &*upper}) {
    EXPECT_GT(placed->consistency, 0.95);
    EXPECT_LT(placed->far_sigma_mm, 0.02);
  }
}

/// The control: a place a tenth of a millimetre off does not pass for one.
TEST(PlacePart, place_beside_the_true_one_does_not_convince) {
  const Patient& p = first();
  const Pose T = p.T_lower * p.T_bite.inverse();
  const PlaceConfig config;
  const Placement here = weigh_placement(p.bite->surface, p.lower->surface, T, config);
  EXPECT_LT(here.form_rms_mm, config.evidence.max_form_mm);
  std::mt19937 draw(5);
  std::normal_distribution<double> any;
  for (int n = 0; n < 5; ++n) {
    Pose beside = T;
    beside.translation() += 0.1 * Vec3d(any(draw), any(draw), any(draw)).normalized();
    const Placement there = weigh_placement(p.bite->surface, p.lower->surface, beside, config);
    EXPECT_GT(there.form_rms_mm, config.evidence.max_form_mm);
  }
}

TEST(PlacePart, jaw_of_another_patient_is_refused) {
  const Mesh other = jaw_mesh(twin::JawSide::kLower, 2, 0.3, kFrom_mm, kTo_mm);
  const LaidPart foreign(scanned(other, from_above, kNoise_mm, 9, Pose::Identity()));
  const auto placed = place_part(*first().bite, foreign, {});
  ASSERT_FALSE(placed) << placed->area_mm2 << ' ' << placed->consistency << ' ' << placed->form_rms_mm;
  EXPECT_EQ(placed.error().code, ErrorCode::kQualityGate);
}

TEST(PlacePart, too_little_overlap_is_refused) {
  const Patient& p = first();
  const Vec3d spot = p.lower_body.vertices[p.lower_body.vertices.size() / 2].cast<double>();
  const auto near_spot = [&](const Vec3d& at, const Vec3d& normal) {
    return from_the_cheek(at, normal) && (at - spot).norm() < 3;
  };
  const LaidPart scrap(scanned(p.lower_body, near_spot, kNoise_mm, 12, p.T_bite));
  EXPECT_FALSE(place_part(scrap, *p.lower, {}));
}

TEST(PlacePart, case_is_laid_in_the_bites_frame_and_says_what_is_missing) {
  const Patient& p = first();
  // One tooth, cut out of the lower jaw.
  const Vec3d tooth = p.lower_body.vertices[p.lower_body.vertices.size() / 3].cast<double>();
  const auto cut_out = [&](const Vec3d& at, const Vec3d& normal) {
    return normal.z() > -0.6 && (at - tooth).head<2>().norm() < 6;
  };
  std::mt19937 draw(77);
  const Pose T_die = drawn_pose(draw);
  CaseParts parts;
  parts["lower"] = std::make_unique<const LaidPart>(p.lower->surface.mesh());
  parts["bite"] = std::make_unique<const LaidPart>(p.bite->surface.mesh());
  parts["die-44"] = std::make_unique<const LaidPart>(
      scanned(jaw_mesh(twin::JawSide::kLower, 1, 0.27, kFrom_mm, kTo_mm), cut_out, kNoise_mm, 31, T_die));
  parts["die-14"] = std::make_unique<const LaidPart>(parts["die-44"]->surface.mesh());
  const PlacedCase placed = place_case(parts, {});
  ASSERT_EQ(placed.parts.size(), 3U);
  ASSERT_TRUE(placed.T_frame_part.contains("die-44"));
  EXPECT_LT(worst_mm(parts["die-44"]->surface.mesh(),
                     placed.T_frame_part.at("die-44").inverse() * p.T_bite * T_die.inverse()),
            0.03);
  EXPECT_FALSE(placed.T_frame_part.contains("die-14"));  // its jaw, the upper, was not scanned
  const std::vector<PartFacts> facts{{.name = "lower", .scanned = true, .mount_serial = "M-1"},
                                     {.name = "bite", .scanned = true, .mount_serial = "M-2"}};
  const auto json = nlohmann::json::parse(case_json(facts, &placed, serial_doubts(facts)));
  EXPECT_EQ(json["frame"], "bite");
  EXPECT_TRUE(json.contains("T_bite_lower"));
  EXPECT_TRUE(json.contains("T_lower_die-44"));
  EXPECT_FALSE(json.contains("T_upper_die-14"));
  EXPECT_EQ(json["warnings"].size(), 1U) << "two mounts in one case are told";
  EXPECT_GT(case_png(parts, placed).size(), 10'000U);
}

TEST(PlacePart, names_of_parts) {
  for (const char* good : {"upper", "lower", "bite", "die-11", "die-48"}) EXPECT_TRUE(check_part(good)) << good;
  for (const char* bad : {"", "Upper", "die", "die-", "die-19", "die-51", "die-1", "die-111", "../upper", "upper/x"})
    EXPECT_FALSE(check_part(bad)) << bad;
  EXPECT_EQ(onto_of("die-21"), "upper");
  EXPECT_EQ(onto_of("die-31"), "lower");
  EXPECT_EQ(onto_of("lower"), "bite");
}

}  // namespace
}  // namespace enamel::host
