#include "tests/e2e/calibrate_set.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "protocol/base/file.hpp"
#include "tests/support/rig_files.hpp"

namespace enamel {

namespace fs = std::filesystem;

void write_set(const std::string& folder) {
  const auto scene = test::make_calib_scene(11, kPoses);
  Rng rng(11, 3, 1);
  for (std::size_t j = 0; j < kPoses; ++j) {
    const auto frames = test::render_pose(scene, j, {}, rng);
    const std::string pose = folder + "/poses/0" + std::to_string(j) + "/";
    fs::create_directories(pose);
    test::write_png(pose + "white.png", frames.white);
    test::write_png(pose + "black.png", frames.black);
    for (const bool is_v : {false, true})
      for (const auto& level : is_v ? frames.along_v : frames.along_u)
        for (std::size_t k = 0; k < 4; ++k)
          test::write_png(pose + (is_v ? "h_" : "v_") + std::to_string(level.cycles) + "_" + std::to_string(k) + ".png",
                          level.frames[k]);
  }
  const auto lens = [](const calib::LensValues& l) {
    return nlohmann::json{{"width", l.width}, {"height", l.height}, {"fx", l.fx},    {"fy", l.fy},
                          {"cx", l.cx},       {"cy", l.cy},         {"dist", l.dist}};
  };
  const nlohmann::json rig{{"format", "rig/1"},
                           {"units", "mm"},
                           {"nominal", true},
                           {"serial", "EN-11"},
                           {"camera", lens(scene.nominal.camera)},
                           {"projector", lens(scene.nominal.projector)},
                           {"T_proj_cam", scene.nominal.T_proj_cam},
                           {"depth_range_mm", {40, 56}},
                           {"patterns", {{"mode", "multi"}, {"steps", 4}, {"cycles", {1, 4, 16, 64}}}},
                           {"noise",
                            {{"full_well_e", 10000},
                             {"read_noise_e", 5},
                             {"bits", 8},
                             {"gain_e_per_dn", 39.84},
                             {"black_dn", 4},
                             {"averaged_frames", 16}}}};
  ASSERT_TRUE(write_file(folder + "/rig.json", rig.dump()));
  ASSERT_TRUE(write_file(folder + "/target.json",
                         R"({"type": "circle_grid", "cols": 9, "rows": 7, "pitch_mm": 1.8, "radius_mm": 0.33})"));
}

}  // namespace enamel
