// What `enamel compare` says beside its figures: units, distance from the origin, what was left out.
#include "host/compare/doubts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/unit/host/mesh_shapes.hpp"

namespace enamel::host {
namespace {

using testing::HasSubstr;

MeshFile scaled(MeshFile file, double factor) {
  for (Vec3f& v : file.mesh.vertices) v *= static_cast<float>(factor);
  return file;
}

Doubts doubts(const MeshFile& mesh, const MeshFile& reference, Alignment alignment = Alignment::kNone) {
  const std::vector<MeshFile> references{reference};
  const auto result = compare(mesh.mesh, references, {.alignment = alignment, .mesh_origin_mm = mesh.origin_mm});
  EXPECT_TRUE(result.has_value());
  const std::vector<std::string> names{"scan.ply", "ref.stl"};
  return doubts_of(mesh, references, names, *result);
}

std::string only(const Doubts& told) {
  EXPECT_EQ(told.words.size(), 1U) << testing::PrintToString(told.words);
  return told.words.empty() ? "" : told.words[0];
}

TEST(Doubts, meshes_of_the_same_unit_raise_none) {
  const Doubts told = doubts(relief(0.5), relief(0.25));
  EXPECT_TRUE(told.words.empty()) << testing::PrintToString(told.words);
  EXPECT_FALSE(told.unit);
}

TEST(Doubts, a_size_that_no_mouth_has_is_told_with_the_factor_that_fits) {
  struct Case {
    double factor;
    const char* words;
  };
  for (const Case& c :
       {Case{1e-3, "metres (times 1000)"}, Case{0.1, "centimetres (times 10)"}, Case{1 / 25.4, "inches (times 25.4)"},
        Case{1 / 304.8, "feet (times 304.8)"}, Case{1e3, "micrometres (times 0.001)"}}) {
    const MeshFile whole = relief(0.5), other = scaled(relief(0.5), c.factor);
    const Doubts reference = doubts(whole, other), mesh = doubts(other, whole);
    EXPECT_THAT(only(reference), HasSubstr(c.words));
    EXPECT_THAT(only(reference), HasSubstr("ref.stl"));
    EXPECT_THAT(only(mesh), HasSubstr(c.words));
    EXPECT_THAT(only(mesh), HasSubstr("scan.ply"));
    EXPECT_TRUE(reference.unit && mesh.unit);
  }
}

TEST(Doubts, two_meshes_in_the_same_wrong_unit_are_told_both) {
  const Doubts told = doubts(scaled(relief(0.5), 1e-3), scaled(relief(0.5), 1e-3));
  ASSERT_EQ(told.words.size(), 2U);
  EXPECT_THAT(told.words[0], HasSubstr("scan.ply"));
  EXPECT_THAT(told.words[1], HasSubstr("metres (times 1000)"));
}

TEST(Doubts, two_sizes_a_unit_apart_that_both_could_be_are_told_when_they_do_not_lie_on_each_other) {
  const MeshFile arch = scaled(relief(0.5), 3.0);
  EXPECT_THAT(only(doubts(scaled(arch, 0.1), arch)), HasSubstr("centimetres (times 10)"));
  EXPECT_THAT(only(doubts(scaled(arch, 0.1), arch, Alignment::kBest)), HasSubstr("centimetres (times 10)"));
  // Control: a patch a tenth as large that lies on it.
  MeshFile patch = arch;
  std::erase_if(patch.mesh.triangles, [&](const auto& t) {
    const Vec3f& v = patch.mesh.vertices[t[0]];
    return std::abs(v.x()) > 3.2F || std::abs(v.y()) > 2.0F;
  });
  const auto whole = parse_mesh(ply_bytes(patch.mesh), MeshFormat::kPly);
  ASSERT_TRUE(whole.has_value());
  patch = *whole;
  patch.left_out = {};
  EXPECT_TRUE(doubts(patch, arch).words.empty());
}

TEST(Doubts, a_reference_that_lies_elsewhere_is_told_with_the_option_that_lays_it_there) {
  MeshFile moved = relief(0.5);
  for (Vec3f& v : moved.mesh.vertices) v += Vec3f(0, 0, 7);
  EXPECT_THAT(only(doubts(relief(0.5), moved)), HasSubstr("--align best"));
  EXPECT_TRUE(doubts(relief(0.5), moved, Alignment::kBest).words.empty()) << "laid on each other";
}

TEST(Doubts, positions_too_far_out_for_micrometres_are_told) {
  MeshFile far = relief(0.5);
  far.origin_mm = Vec3d(200000, 150000, 0);
  EXPECT_TRUE(doubts(far, far).words.empty());
  far.step_mm = 0.015625;
  const Doubts told = doubts(far, far);
  ASSERT_EQ(told.words.size(), 2U);
  EXPECT_THAT(told.words[0], HasSubstr("scan.ply: lies 250 m from the origin"));
  EXPECT_THAT(told.words[0], HasSubstr("15.6 um"));
  EXPECT_FALSE(told.unit);
}

TEST(Doubts, what_was_left_out_is_counted_in_words_and_in_json) {
  MeshFile mesh = relief(0.5), reference = relief(0.5);
  mesh.left_out.unused_vertices = 40;
  reference.left_out.flat_faces = 3;
  const std::vector<MeshFile> references{reference, reference};
  const auto result = compare(mesh.mesh, references, {});
  ASSERT_TRUE(result.has_value());
  const std::vector<std::string> names{"a\xff.ply", "b.stl", "c.stl"};
  const Doubts told = doubts_of(mesh, references, names, *result);
  ASSERT_EQ(told.words.size(), 3U);
  EXPECT_EQ(told.words[2], "c.stl: left out: 3 faces without area");
  const auto j = nlohmann::json::parse(compare_json(*result, told));
  EXPECT_EQ(j["left_out"]["mesh"]["unused_vertices"], 40);
  EXPECT_EQ(j["left_out"]["reference"]["flat_faces"], 6);
  EXPECT_EQ(j["warnings"].size(), 3U);
  EXPECT_TRUE(j.contains("mean_abs_um"));
}

TEST(Doubts, figures_far_out_are_those_at_the_origin) {
  MeshFile mesh = relief(0.5, [](double, double) { return 0.005; }), reference = relief(0.25);
  const std::vector<MeshFile> near{reference};
  for (const Alignment alignment : {Alignment::kNone, Alignment::kBest}) {
    const auto here = compare(mesh.mesh, near, {.alignment = alignment});
    MeshFile moved = reference;
    moved.origin_mm = Vec3d(700000, 650000, -500000);
    const std::vector<MeshFile> far{moved};
    const auto there = compare(mesh.mesh, far, {.alignment = alignment, .mesh_origin_mm = moved.origin_mm});
    ASSERT_TRUE(here.has_value() && there.has_value());
    EXPECT_NEAR(there->mean_abs_um, here->mean_abs_um, 1e-3);
    EXPECT_NEAR(there->coverage_pct, here->coverage_pct, 1e-6);
    // A scan in its own frame is laid on a reference in a hall's.
    if (alignment == Alignment::kBest) {
      const auto between = compare(mesh.mesh, far, {.alignment = alignment});
      ASSERT_TRUE(between.has_value());
      EXPECT_NEAR(between->mean_abs_um, here->mean_abs_um, 0.01);
      EXPECT_LT((between->T_reference_mesh.translation() - moved.origin_mm).norm(), 0.02);
    }
  }
}

}  // namespace
}  // namespace enamel::host
