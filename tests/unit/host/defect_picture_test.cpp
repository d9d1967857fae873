// defects.png: rings where the defects lie, dashed behind the surface.
#include "host/defects/defect_picture.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "host/compare/flat_map.hpp"
#include "tests/unit/host/drawn_surfaces.hpp"

namespace enamel::host {
namespace {

/// Pixels in the ink of rings.
std::vector<cv::Point> inked(const Mesh& mesh, const std::vector<Defect>& defects) {
  const std::vector<std::uint8_t> png = defects_png(mesh, defects);
  const cv::Mat image = cv::imdecode(png, cv::IMREAD_COLOR);
  std::vector<cv::Point> out;
  for (int y = 0; y < std::min(image.rows, FlatMapSize{}.height); ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& p = image.at<cv::Vec3b>(y, x);
      if (p[2] > 190 && p[1] < 60 && p[0] < 60) out.emplace_back(x, y);
    }
  }
  return out;
}

Mesh drawn_ground(std::uint64_t seed) {
  drawn::Draw draw(seed);
  const drawn::Relief relief(draw);
  return drawn::ground(draw, relief, {});
}

Defect at(const Vec3d& place) {
  Defect d;
  d.p_model_mm = place;
  d.size_mm2 = 0.1;
  d.words = "scan here again";
  return d;
}

TEST(DefectPicture, rings_the_place) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Mesh mesh = drawn_ground(seed);
    const Vec3d place = mesh.vertices[mesh.vertices.size() * seed / 5].cast<double>();
    const Vec3d centre = FlatMap(mesh).project(place);
    const std::vector<cv::Point> ink = inked(mesh, {at(place)});
    ASSERT_FALSE(ink.empty()) << seed;
    for (const cv::Point& p : ink)
      EXPECT_LT((Vec3d(p.x, p.y, centre.z()) - centre).norm(), 50) << p << " of seed " << seed;
    EXPECT_TRUE(inked(mesh, {}).empty()) << "the control: nothing to ring";
  }
}

TEST(DefectPicture, dashes_what_lies_behind) {
  const Mesh mesh = drawn_ground(4);
  const Vec3d front = mesh.vertices[mesh.vertices.size() / 2].cast<double>();
  const FlatMap map(mesh);
  const Vec3d away(map.facing(Vec3d::UnitX()), map.facing(Vec3d::UnitY()), map.facing(Vec3d::UnitZ()));
  const std::size_t whole = inked(mesh, {at(front)}).size(), dashed = inked(mesh, {at(front - 4 * away)}).size();
  EXPECT_LT(4 * dashed, 3 * whole);
  EXPECT_GT(dashed, 0U);
}

TEST(DefectPicture, of_nothing_is_none) { EXPECT_TRUE(defects_png(Mesh{}, {}).empty()); }

}  // namespace
}  // namespace enamel::host
