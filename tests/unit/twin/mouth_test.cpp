// What a mouth is made of: which places have which material, where saliva stands, what the truth says of it.
#include <tbb/global_control.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/unit/twin/twin_fixture.hpp"
#include "tools/twin/surface/mesh_file.hpp"

namespace enamel::twin {
namespace {

using namespace testing;  // NOLINT: the fixture is this file's vocabulary

SceneConfig mouth_scene() {
  SceneConfig scene;
  scene.object = ObjectKind::kJaw;
  scene.path = PathKind::kArch;
  scene.arch_path.passes = {{34, 44, 0, 5}};
  scene.jaw.max_edge_mm = 0.3;
  scene.look.material = LookConfig::kMouth;
  return scene;
}

std::size_t count(const TriSurface& mesh, MaterialId id) {
  return static_cast<std::size_t>(
      std::count(mesh.material.begin(), mesh.material.end(), static_cast<std::uint8_t>(id)));
}

TEST(Mouth, crowns_fillings_and_blood_lie_where_they_are_asked_for) {
  SceneConfig scene = mouth_scene();
  const auto sound = make_body(scene);
  ASSERT_TRUE(sound);
  for (const MaterialId id : {MaterialId::kMetal, MaterialId::kAmalgam, MaterialId::kBlood, MaterialId::kDark}) {
    EXPECT_EQ(count(sound->surroundings.mesh, id), 0U);  // control
  }
  scene.look.mouth.metal_crowns = {5};
  scene.look.mouth.amalgam = {6};
  scene.look.mouth.dark = {1};
  scene.look.mouth.blood_mm = {38};
  const auto body = make_body(scene);
  ASSERT_TRUE(body);
  const TriSurface& mesh = body->surroundings.mesh;
  for (const MaterialId id : {MaterialId::kMetal, MaterialId::kAmalgam, MaterialId::kBlood, MaterialId::kDark}) {
    EXPECT_GT(count(mesh, id), 50U) << static_cast<int>(id);
  }
  const PlacedTooth& crown = body->dentition.teeth[4];
  const auto metal = static_cast<std::uint8_t>(MaterialId::kMetal);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const double away = (mesh.vertices[i].cast<double>() - crown.origin).head<2>().norm();
    if (mesh.material[i] != metal) continue;
    EXPECT_LT(away, crown.form.buccolingual);
    EXPECT_NEAR(mesh.albedo[i], 0.05, 0.01);
  }
}

TEST(Mouth, both_sides_number_their_teeth_from_the_middle) {
  const Dentition d = make_dentition(JawSide::kLower, 7, true, 1);
  const std::vector<int> numbers = tooth_numbers(d);
  ASSERT_EQ(numbers.size(), 14U);
  EXPECT_EQ(numbers.front(), -7);
  EXPECT_EQ(numbers[6], -1);
  EXPECT_EQ(numbers[7], 1);
  EXPECT_EQ(numbers.back(), 7);
}

TEST(Mouth, film_covers_its_share_and_pools_fill_fissures) {
  SceneConfig scene = mouth_scene();
  scene.jaw.max_edge_mm = 0.15;
  scene.jaw.from_mm = 32;
  scene.jaw.to_mm = 46;
  scene.look.film.wet_share = 0.4;
  const auto thin = make_body(scene);
  scene.look.film.wet_share = 0;
  scene.look.film.pools_mm = 0.3;
  const auto pools = make_body(scene);
  ASSERT_TRUE(thin && pools);
  const auto wet = [](const Body& body) {
    const auto& film = body.surroundings.mesh.film;
    const auto n = std::count_if(film.begin(), film.end(), [](const Film& f) { return f.thickness_mm > 0; });
    return static_cast<double>(n) / static_cast<double>(film.size());
  };
  EXPECT_NEAR(wet(*thin), 0.4, 0.03);
  EXPECT_GT(wet(*pools), 0.01);
  EXPECT_LT(wet(*pools), 0.25);
  for (const Film& f : pools->surroundings.mesh.film) EXPECT_LE(f.thickness_mm, 0.31F);
  scene.effects.film = false;  // control
  EXPECT_TRUE(make_body(scene)->surroundings.mesh.film.empty());
}

TEST(Mouth, truth_names_materials_and_plaster_says_nothing) {
  SceneConfig scene = mouth_scene();
  scene.look.mouth.ceramic = {4};
  scene.look.film.wet_share = 0.5;
  const auto mouth = make_body(scene);
  scene.effects.film = false;
  const auto dry = make_body(scene);
  scene.look = LookConfig{};
  const auto plaster = make_body(scene);
  ASSERT_TRUE(mouth && dry && plaster);
  const auto json = nlohmann::json::parse(mouth->description_json);
  EXPECT_EQ(json["materials"]["enamel"]["number"], 1);
  EXPECT_EQ(json["materials"]["enamel"]["lobes"].size(), 4U);
  EXPECT_EQ(json["mouth"]["ceramic"][0], 4);
  const std::string ply = write_ply(mouth->surroundings.mesh, {});
  EXPECT_NE(ply.find("property uchar material\nproperty float film_mm\n"), std::string::npos);
  const std::string without = write_ply(dry->surroundings.mesh, {});
  EXPECT_EQ(without.find("film_mm"), std::string::npos);
  const std::size_t vertices = mouth->surroundings.mesh.vertices.size();
  EXPECT_EQ(ply.size() - without.size(),
            sizeof(float) * vertices + std::string_view("property float film_mm\n").size());
  EXPECT_FALSE(nlohmann::json::parse(plaster->description_json).contains("materials"));
  EXPECT_EQ(write_ply(plaster->surroundings.mesh, {}).find("material"), std::string::npos);
}

TEST(Mouth, threads_change_nothing) {
  SceneConfig scene = mouth_scene();
  scene.look.film = {0.7, 80, 0.3, 9};
  scene.look.mouth.metal_crowns = {6};
  const auto burst = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    auto b = source_of(scene, small_rig())->next();
    return (*b)->frames;
  };
  const auto one = burst(1);
  EXPECT_EQ(one, burst(3));
  scene.look.film.wet_share = 0;  // control
  EXPECT_NE(one, burst(3));
}

TEST(Mouth, keys_that_do_not_go_together_are_refused) {
  const auto load = [](std::string_view text) {
    auto reader = ConfigReader::from_text(text, "scene");
    SceneConfig config;
    bind_scene(*reader, config);
    return reader->finish();
  };
  const std::string jaw = "object.type = \"jaw\"\npath.type = \"arch\"\npath.pass = [{}]\n";
  EXPECT_TRUE(load(jaw + "object.material = \"mouth\"\nmouth.amalgam = [-6]\nmaterials.enamel.albedo = 0.5\n"));
  EXPECT_TRUE(load(jaw + "mouth.amalgam = [6]\n"));  // plaster leaves it out
  EXPECT_FALSE(load(jaw + "object.material = \"gum\"\nmouth.amalgam = [6]\n"));
  EXPECT_FALSE(load("object.type = \"plane\"\nmouth.amalgam = [6]\n"));
  EXPECT_FALSE(load(jaw + "object.material = \"mouth\"\nmouth.amalgam = [5.5]\n"));
  EXPECT_FALSE(load(jaw + "object.material = \"mouth\"\nmaterials.enamel.lobe_weights = [1.0]\n"));
  EXPECT_FALSE(load(jaw + "object.material = \"chalk\"\n"));
}

}  // namespace
}  // namespace enamel::twin
