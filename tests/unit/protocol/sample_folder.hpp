// A small exchange folder with everything in it that has to survive: unknown rig fields, odd digits, truth, notes.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "host/record/png_image.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/unit/protocol/random_messages.hpp"

namespace enamel::test {

inline constexpr int kFolderWidth = 20;
inline constexpr int kFolderHeight = 14;

inline std::string folder_rig(int bits) {
  return "{\"format\": \"rig/1\",\n \"camera\": {\"width\": 20, \"height\": 14},  \"unknown\": [1, 2.50],\n \"noise\": "
         "{\"bits\": " +
         std::to_string(bits) + "}}\n\n";
}

inline const std::string kFolderTable =
    "burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c\r\n"
    "0,1000000000,1004004000,1008008000,1012012000,3700,32.00\r\n"
    "3,1033333333,1037337333,1041341333,1045345333,3700,32.1250\r\n"
    "4,1066666666,1070670666,1074674666,1078678666,3600,-0.5\r\n";

inline std::vector<std::uint8_t> frame_pixels(std::uint64_t id, int k, int bits) {
  Random random(id * 4 + static_cast<std::uint64_t>(k) + 1);
  auto pixels = random.octets(static_cast<std::size_t>(kFolderWidth * kFolderHeight * (bits == 8 ? 1 : 2)));
  if (bits > 8) {
    const auto mask = static_cast<std::uint8_t>((1U << static_cast<unsigned>(bits - 8)) - 1U);
    for (std::size_t i = 1; i < pixels.size(); i += 2) pixels[i] &= mask;
  }
  return pixels;
}

inline std::string frame_name(std::uint64_t id, int k) {
  return "/frames/00000" + std::to_string(id) + "_" + std::to_string(k) + ".png";
}

inline void make_folder_sample(const std::string& folder, int bits) {
  spill(folder + "/rig.json", folder_rig(bits));
  spill(folder + "/bursts.csv", kFolderTable);
  std::filesystem::create_directories(folder + "/frames");
  for (const std::uint64_t id : {0U, 3U, 4U}) {
    for (int k = 0; k < 4; ++k) {
      ASSERT_TRUE(host::write_grey_png(folder + frame_name(id, k), kFolderWidth, kFolderHeight, bits,
                                       frame_pixels(id, k, bits)));
    }
  }
  spill(folder + "/truth/poses.csv", std::string("burst_id,t_ns\n0,1\n"));
  spill(folder + "/truth/deep/depth_000000.pfm", std::vector<std::uint8_t>{'P', 'f', '\n', 0, 255, 10, 13, 0});
  spill(folder + "/truth/empty.txt", std::string());
  spill(folder + "/frames/note.txt", std::string("kept too"));
}

}  // namespace enamel::test
