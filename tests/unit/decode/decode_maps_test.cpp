#include "pipeline/decode/decode_maps.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "pipeline/decode/burst_decoder.hpp"
#include "protocol/base/file.hpp"
#include "tests/unit/decode/synthetic.hpp"

namespace enamel::pipeline {
namespace {

DecodedBurst small_burst() {
  const calib::Rig rig = test::cropped_rig(320, 60);
  test::SceneOptions o;
  o.light = [](int u, int) { return u < 300 ? 1.0 : 0.0; };
  return BurstDecoder::make(rig).value().decode(test::render(rig, test::flat(47), o).frames.view());
}

TEST(DecodeMaps, pfm_is_little_endian_and_bottom_up) {
  Map<float> m(2, 2);
  m(0, 0) = 1, m(1, 0) = 2, m(0, 1) = 3, m(1, 1) = 4;
  const std::string bytes = pfm_bytes(m), header = "Pf\n2 2\n-1.0\n";
  ASSERT_EQ(bytes.substr(0, header.size()), header);
  float values[4] = {};
  ASSERT_EQ(bytes.size(), header.size() + sizeof(values));
  std::memcpy(values, bytes.data() + header.size(), sizeof(values));
  EXPECT_THAT(values, testing::ElementsAre(3.0F, 4.0F, 1.0F, 2.0F));
}

TEST(DecodeMaps, writes_every_promised_file) {
  const DecodedBurst burst = small_burst();
  ASSERT_TRUE(burst.accepted());
  const std::string folder = testing::TempDir() + "enamel_decode_maps";
  std::filesystem::remove_all(folder);
  const DecodeReport report{7, "T", {{"unrest", 3, {0.5}}}, {{"phase", 1.5}, {"unwrap", 2.0}}};
  ASSERT_TRUE(write_decode_maps(burst, report, folder));
  for (const char* name : {"phase.pfm", "modulation.pfm", "order.png", "reject.png", "depth.pfm", "sigma.pfm",
                           "points.ply", "decode.json"})
    EXPECT_TRUE(std::filesystem::exists(folder + "/" + name)) << name;
  const cv::Mat order = cv::imread(folder + "/order.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(order.type(), CV_8UC1);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 320; ++u) ASSERT_EQ(order.at<std::uint8_t>(v, u), burst.order(u, v));
  const std::string json = read_file(folder + "/decode.json").value();
  EXPECT_THAT(json, testing::HasSubstr("\"burst\": 7, \"mode\": \"T\""));
  EXPECT_THAT(json, testing::HasSubstr("\"unrest\": 0.500"));
  EXPECT_THAT(json, testing::HasSubstr("\"valid_px\": " + std::to_string(burst.patch.valid_px)));
  EXPECT_THAT(json, testing::HasSubstr("\"stage_ms\": {\"phase\": 1.500, \"unwrap\": 2.000}"));
  const std::string ply = read_file(folder + "/points.ply").value();
  EXPECT_THAT(ply, testing::HasSubstr("element vertex " + std::to_string(burst.patch.valid_px) + "\n"));
  const std::size_t body = ply.size() - ply.find("end_header\n") - 11;
  EXPECT_EQ(body, burst.patch.valid_px * 7 * sizeof(float));
}

TEST(DecodeMaps, folder_that_cannot_be_made_is_an_error_not_a_crash) {
  const auto written = write_decode_maps(small_burst(), {}, "/proc/enamel_cannot_be_here");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kFileWrite);
}

}  // namespace
}  // namespace enamel::pipeline
