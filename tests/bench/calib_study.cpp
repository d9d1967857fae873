// bench_calib_study OUT: measures what the calibration page shows, writes OUT/study.json.
#include "tests/bench/calib_study.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "calib/solve/camera_alone.hpp"
#include "protocol/base/file.hpp"
#include "tests/bench/calib_opencv.hpp"
#include "tests/bench/study.hpp"
#include "tests/support/calib_scene.hpp"
#include "tests/support/procam_set.hpp"
#include "tests/support/shared_data.hpp"

namespace enamel::bench {
namespace {

Json camera_study(const std::string& folder) {
  std::vector<std::pair<std::string, std::string>> pictures;
  for (int n = 1; n <= 14; ++n) {
    char name[32];
    std::snprintf(name, sizeof name, "left%02d.jpg", n);
    if (std::filesystem::exists(folder + "/" + name)) pictures.emplace_back(name, folder + "/" + name);
  }
  calib::TargetDesign board;
  board.type = calib::TargetType::kChessboard;
  board.cols = 9;
  board.rows = 6;
  board.pitch_mm = 25;
  const auto camera = calib::solve_camera(pictures, board).value();
  return {{"fx", camera.start.lens.fx},
          {"fy", camera.start.lens.fy},
          {"rms_px", camera.start.rms_px},
          {"pictures", camera.poses.size()}};
}

Json procam_study(const std::string& folder) {
  const test::ProcamSet set = test::load_procam(folder).value();
  const auto solved = calib::solve(set.views, set.board, set.nominal, test::procam_options());
  if (!solved) return {{"refused", solved.error().detail}};
  const auto& r = solved->result;
  const auto sigma = [&](Eigen::Index i) { return std::sqrt(r.covariance(i, i)); };
  const auto peer = stereo_calibrate(solved->poses, set.board, set.nominal);
  std::vector<std::pair<std::string, std::string>> pictures;
  for (const auto& view : set.views) pictures.emplace_back(view.name, folder + "/" + view.name + "/white_full.png");
  const auto alone = calib::solve_camera(pictures, set.board).value();
  return {{"alone_fx", alone.start.lens.fx},
          {"alone_fy", alone.start.lens.fy},
          {"camera_fx", solved->state.camera.fx},
          {"camera_fy", solved->state.camera.fy},
          {"camera_fx_sigma", sigma(0)},
          {"projector_fx", solved->state.projector.fx},
          {"projector_fy", solved->state.projector.fy},
          {"projector_fx_sigma", sigma(8)},
          {"projector_cy", solved->state.projector.cy},
          {"projector_cy_sigma", sigma(11)},
          {"rms_camera_px", r.rms_camera_px},
          {"rms_projector_px", r.rms_projector_px},
          {"rms_px", std::hypot(r.rms_camera_px, r.rms_projector_px) / std::sqrt(2.0)},
          {"opencv_camera_fx", peer.state.camera.fx},
          {"opencv_projector_fx", peer.state.projector.fx},
          {"opencv_rms_px", std::hypot(peer.rms_camera_px, peer.rms_projector_px) / std::sqrt(2.0)},
          {"poses", solved->poses.size()}};
}

/// Twenty poses in memory: what solving takes once they are measured.
double solve_ms() {
  const auto scene = test::make_calib_scene(20, 20);
  Rng rng(20, 1, 1);
  const auto views = test::make_views(scene, {}, rng);
  const double begin = thread_ms();
  const auto solved = calib::solve(views, scene.target, scene.nominal, {});
  return solved ? thread_ms() - begin : NAN;
}

}  // namespace

Json captured_study(const std::string& data) {
  Json json = Json::object();
  if (std::filesystem::exists(data + "/opencv_stereo_chessboard"))
    json["camera"] = camera_study(data + "/opencv_stereo_chessboard");
  if (std::filesystem::exists(data + "/procam_graycode_chessboard"))
    json["procam"] = procam_study(data + "/procam_graycode_chessboard");
  return json;
}

}  // namespace enamel::bench

int main(int argc, char** argv) {
  namespace bench = enamel::bench;
  if (argc != 2) {
    std::fputs("usage: bench_calib_study OUT\n", stderr);
    return 1;
  }
  const std::string shared = enamel::test::shared_folder();
  const auto say = [](const char* what) { std::fprintf(stderr, "calibration: %s ...\n", what); };
  bench::Json json;
  say("captured chessboards");
  json["captured"] = bench::captured_study(shared + "/data/calib");
  say("centres of discs");
  json["centres"] = bench::centres_study();
  say("sixty rigs");
  json["rigs"] = bench::Json::array({bench::rigs_study(300), bench::rigs_study(1000)});
  say("twenty real boards");
  json["boards"] = bench::boards_study();
  say("rendered set");
  json["rendered"] = bench::rendered_study(shared + "/data/oracle/calib-01");
  json["solve_20_poses_ms"] = bench::solve_ms();
  const auto written = enamel::write_file(std::string(argv[1]) + "/study.json", json.dump(1) + "\n");
  if (!written) std::fprintf(stderr, "%s\n", written.error().message().c_str());
  return written ? 0 : 2;
}
