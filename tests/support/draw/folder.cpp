#include "tests/support/draw/folder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "calib/model/pattern.hpp"
#include "pipeline/decode/decode_maps.hpp"
#include "protocol/base/file.hpp"

namespace enamel::test {
namespace {

using Json = nlohmann::ordered_json;

Json lens_json(const calib::LensValues& l) {
  return {{"width", l.width}, {"height", l.height}, {"fx", l.fx},    {"fy", l.fy},
          {"cx", l.cx},       {"cy", l.cy},         {"dist", l.dist}};
}

Json pattern_json(const calib::PatternValues& p) {
  Json out = {
      {"mode", calib::mode_name(p)}, {"axis", "u"}, {"period_px", p.period_px}, {"steps", p.steps}, {"mean", p.mean},
      {"amplitude", p.amplitude}};
  if (p.mode == calib::PatternMode::kMicro) {
    out["code_ratio"] = p.code_ratio;
  } else {
    std::string code;
    for (const int sign : p.polarity_code) code += sign > 0 ? '+' : '-';
    out["polarity_code"] = code, out["first_cell"] = p.first_cell;
  }
  return out;
}

Result<void> write_png(const std::string& path, int width, int height, std::vector<std::uint8_t> pixels) {
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", cv::Mat(height, width, CV_8UC1, pixels.data()), png))
    return fail(ErrorCode::kFileWrite, path + " cannot be encoded");
  return write_file(path, std::string(png.begin(), png.end()));
}

Result<void> write_truth(const Drawn& drawn, const DrawnTruth& truth, const std::string& folder) {
  constexpr std::uint8_t kLit = 255, kNoFringe = 255;
  const int w = truth.lit.width(), h = truth.lit.height();
  std::vector<std::uint8_t> lit, order;
  for (std::size_t i = 0; i < truth.lit.size(); ++i) {
    lit.push_back(truth.lit[i] != 0 ? kLit : 0);
    const double column = truth.column_px[i];
    const bool inside = column > -0.5 && column < drawn.rig.projector.width - 0.5;
    order.push_back(inside ? static_cast<std::uint8_t>(std::max(0.0, std::floor(column / drawn.rig.patterns.period_px)))
                           : kNoFringe);
  }
  ENAMEL_TRY(write_png(folder + "/lit_000000.png", w, h, std::move(lit)));
  ENAMEL_TRY(write_png(folder + "/order_000000.png", w, h, std::move(order)));
  ENAMEL_TRY(write_file(folder + "/depth_000000.pfm", pipeline::pfm_bytes(truth.depth_mm)));
  const Eigen::Isometry3d pose = drawn.scene.T_cam_scene.inverse();
  const Eigen::Quaterniond q(pose.linear());
  const Point3 t = pose.translation();
  return write_file(folder + "/poses.csv",
                    fmt::format("burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw\n0,1007856000,{},{},{},{},{},{},{}\n", t.x(), t.y(),
                                t.z(), q.x(), q.y(), q.z(), q.w()));
}

}  // namespace

std::string rig_json(const calib::Rig& rig) {
  const calib::NoiseValues& n = *rig.noise;
  const Json out = {{"format", "rig/1"},
                    {"units", "mm"},
                    {"camera", lens_json(rig.camera)},
                    {"projector", lens_json(rig.projector)},
                    {"T_proj_cam", rig.T_proj_cam},
                    {"patterns", pattern_json(rig.patterns)},
                    {"depth_range_mm", {rig.depth_range->near_mm, rig.depth_range->far_mm}},
                    {"noise",
                     {{"full_well_e", n.full_well_e},
                      {"read_noise_e", n.read_noise_e},
                      {"bits", n.bits},
                      {"gain_e_per_dn", n.gain_e_per_dn},
                      {"black_dn", n.black_dn}}}};
  return out.dump(1);
}

Result<void> write_folder(const Drawn& drawn, const DrawnBurst& burst, const std::string& folder) {
  std::error_code ignored;  // what cannot be made cannot be written to, either
  std::filesystem::create_directories(folder + "/frames", ignored);
  std::filesystem::create_directories(folder + "/truth", ignored);
  ENAMEL_TRY(write_file(folder + "/rig.json", rig_json(drawn.rig)));
  ENAMEL_TRY(
      write_file(folder + "/bursts.csv", std::string("burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c\n"
                                                     "0,1000000000,1004004000,1008008000,1012012000,3700,32.00\n")));
  for (std::size_t k = 0; k < 4; ++k) {
    ENAMEL_TRY(write_png(fmt::format("{}/frames/000000_{}.png", folder, k), burst.frames.width, burst.frames.height,
                         burst.frames.frames[k]));
  }
  return write_truth(drawn, burst.truth, folder + "/truth");
}

}  // namespace enamel::test
