// How fine parts of the model are drawn, and what is left of a surface that is made coarse.
#include "viewer/scene/detail.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "viewer/scene/coarse_mesh.hpp"
#include "viewer/scene/model_parts.hpp"

namespace enamel::view::test {
namespace {

constexpr float kStepMm = 0.1F;

/// A smooth height field over [x0, x1) x [0, 3.2) mm, on a grid whose lines all parts share.
struct Waves {
  explicit Waves(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> draw(0.3F, 1.4F);
    for (float& v : k) v = draw(random);
  }
  [[nodiscard]] Vec3f at(int i, int j) const {
    const float x = kStepMm * static_cast<float>(i), y = kStepMm * static_cast<float>(j);
    return {x, y, k[0] * std::sin(k[1] * x + k[2] * y) + 0.4F * std::cos(k[3] * y)};
  }
  [[nodiscard]] BlockMesh part(int i0, int i1, std::int32_t block) const {
    BlockMesh mesh;
    mesh.block = {block, 0, 0};
    constexpr int kRows = 32;
    for (int i = i0; i <= i1; ++i) {
      for (int j = 0; j <= kRows; ++j) mesh.vertices.push_back(at(i, j));
    }
    const auto id = [&](int i, int j) { return static_cast<std::uint32_t>((i - i0) * (kRows + 1) + j); };
    for (int i = i0; i < i1; ++i) {
      for (int j = 0; j < kRows; ++j) {
        mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i, j + 1)});
        mesh.triangles.push_back({id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)});
      }
    }
    return mesh;
  }
  std::array<float, 4> k{};
};

float nearest_mm(const Vec3f& p, const BlockMesh& mesh) {
  float best = std::numeric_limits<float>::max();
  for (const Vec3f& v : mesh.vertices) best = std::min(best, (v - p).norm());
  return best;
}

/// y and z of the coarse vertices at this x.
std::set<std::pair<float, float>> on_line(const BlockMesh& mesh, const std::vector<IndexTriangle>& coarse, float x) {
  std::set<std::pair<float, float>> out;
  for (const IndexTriangle& t : coarse) {
    for (const std::uint32_t index : t) {
      const Vec3f& p = mesh.vertices[index];
      if (p.x() == x) out.emplace(p.y(), p.z());
    }
  }
  return out;
}

TEST(CoarseMesh, stays_within_the_diagonal_of_a_cell_and_loses_most_triangles) {
  CoarseMesher mesher;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const BlockMesh mesh = Waves(seed).part(0, 32, 0);
    const std::vector<MeshPart> parts{{&mesh, 0}};
    std::size_t before = mesh.triangles.size();
    for (const float cell_mm : kCoarseCellMm) {
      const auto coarse = mesher.coarser(parts, cell_mm);
      EXPECT_LT(10 * coarse.size(), 6 * before) << "cell " << cell_mm;
      ASSERT_GT(coarse.size(), 4U);
      before = coarse.size();
      float worst = 0, widest = 0;
      for (const IndexTriangle& t : coarse) {
        const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
        worst = std::max(worst, nearest_mm((a + b + c) / 3, mesh));
        widest = std::max({widest, (a - b).norm(), (b - c).norm(), (c - a).norm()});
      }
      const float diagonal = std::sqrt(3.0F) * cell_mm, spacing = 2 * kStepMm;
      EXPECT_LT(worst, diagonal + spacing);
      EXPECT_LT(widest, 2 * diagonal + spacing);
    }
  }
}

TEST(CoarseMesh, parts_beside_each_other_meet_where_both_have_the_same_cell) {
  CoarseMesher mesher;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Waves waves(seed);
    const BlockMesh left = waves.part(0, 32, 0), right = waves.part(32, 64, 1);
    const float border = waves.at(32, 0).x();
    const auto edge = [&](const BlockMesh& mesh, float cell_mm) {
      return on_line(mesh, mesher.coarser(std::vector<MeshPart>{{&mesh, 0}}, cell_mm), border);
    };
    for (const float cell_mm : kCoarseCellMm) {
      EXPECT_EQ(edge(left, cell_mm), edge(right, cell_mm)) << cell_mm;
      EXPECT_GE(edge(left, cell_mm).size(), 3U);
    }
    EXPECT_NE(edge(left, kCoarseCellMm[0]), edge(right, kCoarseCellMm[2])) << "control";
  }
}

TEST(CoarseMesh, blocks_of_a_part_are_one_surface) {
  CoarseMesher mesher;
  const Waves waves(7);
  const BlockMesh left = waves.part(0, 16, 0), right = waves.part(16, 32, 1), whole = waves.part(0, 32, 0);
  const auto of_both = mesher.coarser(
      std::vector<MeshPart>{{&left, 0}, {&right, static_cast<std::uint32_t>(left.vertices.size())}}, 0.4F);
  EXPECT_EQ(of_both.size(), mesher.coarser(std::vector<MeshPart>{{&whole, 0}}, 0.4F).size());
  BlockMesh apart = right;  // not the same border: two surfaces, each with an edge
  for (Vec3f& p : apart.vertices) p.z() += 0.01F;
  EXPECT_GT(mesher.coarser(std::vector<MeshPart>{{&left, 0}, {&apart, 5000}}, 0.4F).size(), of_both.size())
      << "control";
}

/// Parts in a plane, 3 mm apart, seen from above.
std::vector<DetailPart> field_of_parts(int side) {
  std::vector<DetailPart> parts;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      DetailPart part;
      part.ball = {{3.0 * (i - side / 2), 3.0 * (j - side / 2), 0}, 2.2};
      part.triangles = {2500, 900, 250, 80, 30};
      parts.push_back(part);
    }
  }
  return parts;
}

std::size_t sum_of(const std::vector<DetailChoice>& choices, const std::vector<DetailPart>& parts) {
  std::size_t sum = 0;
  for (const DetailChoice& c : choices) sum += parts[c.part].triangles[c.level];
  return sum;
}

DetailView tilted_view() {
  DetailView view;
  view.camera.R_model_view = Eigen::AngleAxisd(0.9, Vec3d::UnitX());
  view.camera.distance_mm = 150;
  view.aspect = 1.6;
  view.height_px = 800;
  return view;
}

TEST(Detail, keeps_the_budget_and_gives_up_what_is_far_first) {
  const auto parts = field_of_parts(20);
  const DetailView view = tilted_view();
  const auto all = choose_detail(parts, view, std::numeric_limits<std::size_t>::max());
  EXPECT_EQ(sum_of(all, parts), 2500 * all.size());
  for (const std::size_t budget : {600'000U, 200'000U, 60'000U, 30'000U}) {
    const auto chosen = choose_detail(parts, view, budget);
    ASSERT_EQ(chosen.size(), all.size()) << "nothing is left out";
    EXPECT_LE(sum_of(chosen, parts), budget);
    for (std::size_t i = 1; i < chosen.size(); ++i) EXPECT_GE(chosen[i].level, chosen[i - 1].level) << "nearest first";
  }
  EXPECT_GT(sum_of(all, parts), 600'000U) << "control: the budgets bind";
}

TEST(Detail, the_place_being_scanned_is_drawn_as_it_is) {
  const auto parts = field_of_parts(20);
  DetailView view = tilted_view();
  const auto finest = [&](std::size_t budget) {
    std::size_t of_focus = 0;
    for (const DetailChoice& c : choose_detail(parts, view, budget)) {
      const bool in_focus = (parts[c.part].ball.centre - Vec3d(6, 9, 0)).norm() < 6;
      of_focus += in_focus && c.level == 0 ? 1U : 0U;
    }
    return of_focus;
  };
  EXPECT_EQ(finest(60'000), 0U) << "control: without a focus it is made coarse, too";
  view.focus = Ball{{6, 9, 0}, 6};
  EXPECT_EQ(finest(120'000), finest(1'000'000));
  EXPECT_GE(finest(120'000), 9U);
}

TEST(Detail, what_is_out_of_view_is_not_drawn) {
  auto parts = field_of_parts(4);
  const DetailView view = tilted_view();
  const std::size_t seen = choose_detail(parts, view, 1'000'000).size();
  EXPECT_EQ(seen, parts.size());
  for (const Vec3d& away : {Vec3d(400, 0, 0), Vec3d(0, 400, 0), Vec3d(0, -400, 600)}) {
    DetailPart part = parts.front();
    part.ball.centre = away;
    parts.push_back(part);
  }
  EXPECT_EQ(choose_detail(parts, view, 1'000'000).size(), seen);
}

TEST(DetailBudget, shrinks_at_once_and_grows_slowly_where_it_binds) {
  DetailBudget budget(20, 100'000);
  budget.drawn(40, 100'000);
  EXPECT_EQ(budget.triangles(), 80'000U);
  budget.drawn(18, 80'000);
  EXPECT_EQ(budget.triangles(), 80'000U) << "near the target it stays";
  budget.drawn(5, 10'000);
  EXPECT_EQ(budget.triangles(), 80'000U) << "a small model tells nothing";
  budget.drawn(5, 80'000);
  EXPECT_EQ(budget.triangles(), 84'000U);
  for (int i = 0; i < 100; ++i) budget.drawn(500, budget.triangles());
  EXPECT_EQ(budget.triangles(), DetailBudget::kLeast) << "pixels alone are too slow";
  for (int i = 0; i < 1000; ++i) budget.drawn(0, budget.triangles());
  EXPECT_EQ(budget.triangles(), DetailBudget::kMost);
}

TEST(DetailBudget, pixels_go_where_triangles_no_longer_help_and_come_back_first) {
  DetailBudget budget(20, DetailBudget::kLeast);
  budget.drawn(60, 10'000), budget.drawn(60, 10'000), budget.drawn(10, 10'000);
  EXPECT_EQ(budget.sharpness(), 1) << "two slow frames beside other work";
  for (int i = 0; i < 3; ++i) budget.drawn(60, 10'000);
  EXPECT_EQ(budget.sharpness(), 0.75);
  for (int i = 0; i < 50; ++i) budget.drawn(60, 10'000);
  EXPECT_EQ(budget.sharpness(), 0.5) << "and no less";
  for (int i = 0; i < 100; ++i) budget.drawn(8, DetailBudget::kLeast);
  EXPECT_EQ(budget.sharpness(), 0.5) << "18 ms with more pixels: it would go to and fro";
  for (int i = 0; i < 20; ++i) budget.drawn(5, DetailBudget::kLeast);
  EXPECT_EQ(budget.sharpness(), 0.75);
  EXPECT_EQ(budget.triangles(), DetailBudget::kLeast) << "more of them wait";
  for (int i = 0; i < 40; ++i) budget.drawn(5, budget.triangles());
  EXPECT_EQ(budget.sharpness(), 1);
  EXPECT_GT(budget.triangles(), DetailBudget::kLeast);
  for (int i = 0; i < 5; ++i) budget.drawn(60, 4 * DetailBudget::kLeast);
  EXPECT_EQ(budget.sharpness(), 1) << "the triangles' fault";
}

TEST(DetailBudget, pixels_settle_within_the_time_of_a_frame) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> noise(0.9, 1.1);
  for (const double pixels_ms : {10.0, 30.0, 60.0}) {
    DetailBudget budget(20, DetailBudget::kSoftwareStart);
    double last_ms = 0, sharpness = 1;
    int changes = 0;
    for (int i = 0; i < 600; ++i) {
      last_ms = noise(random) * (2 + pixels_ms * budget.sharpness() * budget.sharpness());
      budget.drawn(last_ms, 20'000);
      changes += i > 100 && budget.sharpness() != sharpness ? 1 : 0;
      sharpness = budget.sharpness();
    }
    EXPECT_LT(last_ms, 21) << pixels_ms;
    EXPECT_EQ(changes, 0) << pixels_ms;
  }
}

TEST(DetailBudget, finds_what_a_machine_draws_in_time) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(0.9, 1.1);
  for (const double ns_per_triangle : {20.0, 100.0, 300.0}) {
    DetailBudget budget(20, DetailBudget::kSoftwareStart);
    double last_ms = 0;
    for (int i = 0; i < 300; ++i) {
      const std::size_t triangles = budget.triangles();
      last_ms = noise(random) * (5 + 1e-6 * ns_per_triangle * static_cast<double>(triangles));
      budget.drawn(last_ms, triangles);
    }
    EXPECT_GT(last_ms, 10) << ns_per_triangle;
    EXPECT_LT(last_ms, 24) << ns_per_triangle;
  }
}

TEST(ModelParts, draws_what_it_was_given_and_nothing_that_was_taken_away) {
  const Waves waves(5);
  ModelParts parts;
  const DetailView view = [] {
    DetailView v = tilted_view();
    v.camera.target = {3, 1.6, 0};
    return v;
  }();
  for (std::int32_t b = 0; b < 8; ++b)
    parts.put(std::make_shared<BlockMesh>(waves.part(8 * b, 8 * b + 8, b)), static_cast<std::uint32_t>(1000 * b));
  const std::size_t whole = parts.triangles();
  EXPECT_EQ(whole, 8U * 8 * 32 * 2);
  EXPECT_EQ(parts.select(view, whole).size(), whole);
  EXPECT_FALSE(parts.coarse());
  EXPECT_LE(parts.select(view, whole / 4).size(), whole / 4);
  EXPECT_TRUE(parts.coarse());
  std::size_t exact = 0;
  std::optional<std::size_t> next;
  do {
    exact += parts.exact(view, next, whole / 2).size();
  } while (next);
  EXPECT_EQ(exact, whole);
  const std::uint64_t before = parts.revision();
  for (std::int32_t b = 0; b < 8; ++b) parts.remove({b, 0, 0});
  EXPECT_NE(parts.revision(), before);
  EXPECT_TRUE(parts.select(view, whole).empty());
}

}  // namespace
}  // namespace enamel::view::test
